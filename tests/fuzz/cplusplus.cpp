// C++ allocations go through malloc() as the linker has wrapped it, in libraries as well; but not
// while tinygltf parses, which throws through functions that may not throw: a parser that ends its
// process is what the worker processes are for (server/sandbox).
#include <cstdlib>
#include <new>
#include <string>

#include "tests/fuzz/fuzz.h"

// TinyGLTF::LoadASCIIFromString and LoadBinaryFromMemory, by the names that the linker wraps.
#define LOAD_TEXT(prefix)                                                                          \
    prefix##_ZN8tinygltf8TinyGLTF19LoadASCIIFromStringEPNS_5ModelEPNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEES9_PKcjRKS8_j
#define LOAD_BINARY(prefix)                                                                        \
    prefix##_ZN8tinygltf8TinyGLTF20LoadBinaryFromMemoryEPNS_5ModelEPNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEES9_PKhjRKS8_j

typedef bool load(void *loader, void *model, std::string *error, std::string *warning,
                  const void *bytes, unsigned length, const std::string &folder, unsigned sections);

extern "C" {
load LOAD_TEXT(__real_), LOAD_BINARY(__real_), LOAD_TEXT(__wrap_), LOAD_BINARY(__wrap_);

bool LOAD_TEXT(__wrap_)(void *loader, void *model, std::string *error, std::string *warning,
                        const void *bytes, unsigned length, const std::string &folder,
                        unsigned sections)
{
    fuzz_spare_memory(true);
    bool ok = LOAD_TEXT(__real_)(loader, model, error, warning, bytes, length, folder, sections);
    fuzz_spare_memory(false);
    return ok;
}

bool LOAD_BINARY(__wrap_)(void *loader, void *model, std::string *error, std::string *warning,
                          const void *bytes, unsigned length, const std::string &folder,
                          unsigned sections)
{
    fuzz_spare_memory(true);
    bool ok = LOAD_BINARY(__real_)(loader, model, error, warning, bytes, length, folder, sections);
    fuzz_spare_memory(false);
    return ok;
}
}

void *operator new(std::size_t size)
{
    void *block = std::malloc(size > 0 ? size : 1);
    if (!block)
        throw std::bad_alloc();
    return block;
}

void *operator new[](std::size_t size)
{
    return operator new(size);
}

void *operator new(std::size_t size, const std::nothrow_t &) noexcept
{
    return std::malloc(size > 0 ? size : 1);
}

void *operator new[](std::size_t size, const std::nothrow_t &) noexcept
{
    return std::malloc(size > 0 ? size : 1);
}

void operator delete(void *block) noexcept
{
    std::free(block);
}

void operator delete[](void *block) noexcept
{
    std::free(block);
}

void operator delete(void *block, std::size_t) noexcept
{
    std::free(block);
}

void operator delete[](void *block, std::size_t) noexcept
{
    std::free(block);
}
