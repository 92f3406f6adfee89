# The targets:
#   make            build/sheend, its workers build/sheend-cage and build/sheend-image, build/sheen
#   make demo       installs missing packages, builds, renders the demo model to a PNG
#   make check      installs missing packages, builds, lints, runs every test
#   make unit | oracle | service    one kind of test
#   make oracle     DEVICE=native|mesa|N ISA=v2|v3|v4: the device that the oracles judge (default: native, the widest set)
#   make test       T=NAME: one row of what `make check` prints; see tests/README.md
#   make fuzz       SECONDS=60: fuzzes each target of tests/fuzz for so long (needs clang-14: sh deploy/deps.sh fuzz),
#                   and a daemon with AddressSanitizer by sequences of messages
#   make fuzz-coverage   the lines of protocol/, the readers and the workers' messages that the corpora reach
#   make soak       the service under load, SECONDS for each part (60), and 102 killed processes; prints
#                   figures and judges ratios
#   make bench      measures speed by the programs of tests/bench, RUNS=9 of each; writes figures to
#                   build/bench, and in the end prints every ratio beside that of the previous run
#   make sheen-bench   one program with the renderer's benchmarks, for a machine that has only EGL and libepoxy
#   make arm64      compiles the native device for arm64, where vectors have 4 lanes, but runs nothing
#   make lint       format, static analysis, dependency rules
#   make format     formats the sources with clang-format
#   make deps       installs Debian packages (needs root or sudo)
#   make install    PREFIX=/usr/local LIBDIR=PREFIX/lib PYTHONDIR=PREFIX/lib/python3.N/dist-packages DESTDIR=:
#                   installs programs, libsheen, the Python package, manual pages, completions and systemd's
#                   units; builds nothing that `make` has built
#   make wheel      build/python/sheen-VERSION-py3-none-any.whl, for pip; needs no network
#   make clean
# SANITIZE=1 builds everything with AddressSanitizer and UBSan into build/sanitize, SANITIZE=thread
# with ThreadSanitizer into build/thread. FUZZ=1 and COVERAGE=1 are the builds of make fuzz and
# make fuzz-coverage.

VERSION := 0.1.0
# The date in manual pages is that of the version, so that equal sources give equal files.
DATE := 2026-11-30
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
# Where Debian's Python looks for packages that are installed below PREFIX.
PYTHONDIR ?= $(PREFIX)/lib/$(if $(filter /usr,$(PREFIX)),python3,$(shell /usr/bin/python3 -c 'import sys; print("python%d.%d" % sys.version_info[:2])'))/dist-packages
CC ?= gcc
CXX ?= g++
.DEFAULT_GOAL := all
SANITIZE ?=
FUZZ ?=
COVERAGE ?=
SECONDS ?= 60
RUNS ?= 9
# The number of commands that `make check` and `make demo` run in parallel.
JOBS ?= $(shell nproc)

comma := ,
BUILD := build$(if $(FUZZ),/fuzz,$(if $(COVERAGE),/coverage,$(if $(SANITIZE),$(if $(filter thread,$(SANITIZE)),/thread,/sanitize))))
SANITIZERS := $(if $(filter thread,$(SANITIZE)),thread,address$(comma)undefined)
CHECKED := -O1 -fsanitize=$(SANITIZERS) -fno-sanitize-recover=all -fno-omit-frame-pointer
OPT := $(if $(FUZZ)$(SANITIZE),$(CHECKED),$(if $(COVERAGE),-O0 --coverage,-O2))
ifneq ($(FUZZ),)
CC := clang-14
CXX := clang++-14
OPT += -fsanitize=fuzzer-no-link
endif
WARN := -Wall -Wextra -Werror -Wshadow -Wundef -Wvla -Wpointer-arith -Wcast-qual
CWARN := $(WARN) -Wstrict-prototypes -Wmissing-prototypes -Wold-style-definition
# With sanitizers lines and functions only, which is what their reports print.
SYMBOLS := $(if $(SANITIZE),-g1,-g)
# Guards of the stack and of jumps, as far as the compiler has them for its processor.
GUARDS := $(foreach flag,-fstack-clash-protection -fcf-protection,\
            $(shell $(CC) -Werror $(flag) -x c -S -o /dev/null /dev/null 2>/dev/null && echo $(flag)))
# Without contraction of floating-point operations, tables do not depend on the processor that builds them.
# With -ffile-prefix-map two folders give equal programs.
BASE := $(OPT) $(SYMBOLS) $(if $(COVERAGE),,-ffile-prefix-map=$(CURDIR)=.) -ffp-contract=off -fstack-protector-strong $(GUARDS) -D_FORTIFY_SOURCE=$(if $(FUZZ)$(SANITIZE)$(COVERAGE),0,2) \
        -I. -I$(BUILD)/gen -MMD -MP -DSHEEN_VERSION=\"$(VERSION)\" -pthread
CFLAGS += -std=c11 -D_GNU_SOURCE $(CWARN) $(BASE)
# UBSan's check of vptr makes a pipe, which worker processes may not do.
# With a sanitizer GCC 12 warns falsely that std::regex is uninitialised.
CXXFLAGS += -std=c++17 $(WARN) $(BASE) $(if $(SANITIZE),-fno-sanitize=vptr -Wno-maybe-uninitialized)
LDFLAGS += $(OPT) -pthread -Wl,-z,relro,-z,now

NANOPB := /usr/bin/python3 /usr/bin/nanopb_generator.py -q
GEN := $(BUILD)/gen/sheen.pb.h $(BUILD)/gen/sheen.pb.c $(BUILD)/gen/shaders.c $(BUILD)/gen/edge_rays.inc

# V=1 shows every command.
Q := $(if $(V),,@)
say = $(if $(V),,@echo '  $(1)')

obj = $(patsubst %,$(BUILD)/obj/%.o,$(1))
PROTOCOL_SRC := $(wildcard protocol/*.c protocol/messages/*.c)
CAGE_SRC := $(wildcard server/cage/*.c)
CAGE_READ_SRC := $(wildcard server/cage/build/*.c server/cage/read/*.c server/cage/read/*/*.c server/cage/read/gltf/*.cpp)
SURFACE_SRC := $(wildcard server/surface/*.c server/surface/topology/*.c server/surface/subdivision/*.c server/surface/spline/*.c server/surface/plan/*.c)
# Converts between messages and scenes: only for programs that speak the protocol.
CONVERT_SRC := $(wildcard server/scene/scene_convert*.c)
SCENE_SRC := $(filter-out $(CONVERT_SRC),$(wildcard server/scene/*.c))
CURVES_SRC := $(wildcard server/curves/*.c server/curves/*/*.c)
RENDER_SRC := $(wildcard server/render/*.c server/render/gl/*.c server/render/gl/*/*.c server/render/native/*.c server/render/native/frame/*.c server/render/native/clip/*.c server/render/native/polygons/*.c server/render/native/rays/*.c)
# These sources are compiled once for each instruction set: its name, its lanes, and its compiler flags.
LANES_SRC := $(wildcard server/render/native/lanes/*.c)
ifneq ($(findstring x86_64,$(shell $(CC) -dumpmachine)),)
LANE_SETS := v2 v3 v4
LANES_v2 := -DLANES=4 -march=x86-64-v2
LANES_v3 := -DLANES=8 -march=x86-64-v3
LANES_v4 := -DLANES=16 -march=x86-64-v4 -mprefer-vector-width=512
else
LANE_SETS := base
LANES_base := -DLANES=4
endif
# Of the instruction sets, sanitizers check the one that `auto` takes on this machine. The others have the same source,
# and without sanitizers they are compiled in a fifth of the time.
has_flag = $(shell grep -o -m 1 -w $(1) /proc/cpuinfo)
CHECKED_SET := $(lastword $(firstword $(LANE_SETS)) $(filter $(LANE_SETS),$(if $(call has_flag,avx2),v3) $(if $(call has_flag,avx512vl),v4)))
ifneq ($(SANITIZE),)
$(foreach set,$(filter-out $(CHECKED_SET),$(LANE_SETS)),$(eval LANES_$(set) += -fno-sanitize=all -O2))
endif
# GCC 12 warns about values that its own intrinsics leave undefined on purpose, and about vectors that are passed in
# other registers than by older compilers, which is harmless because no function here is called from another unit.
# -g1: lines and functions only, because names of generated variables are useless and take a quarter of the
# compiler's time. -fno-exceptions: ThreadSanitizer ends every function by a handler of exceptions, which would
# need the runtime of C++ in sheend.
LANES_CXXFLAGS := $(if $(FUZZ)$(COVERAGE),-O2) $(if $(SANITIZE),-fno-exceptions) -g1 -Wno-uninitialized -Wno-maybe-uninitialized -Wno-psabi -Wno-unused -Wno-unused-parameter -Wno-shadow
# Frames of two instruction sets need not have the same bytes.
LANES_FLAGS := $(if $(FUZZ)$(SANITIZE)$(COVERAGE),,-O3) -ffp-contract=fast -fno-math-errno -fno-trapping-math
IMAGE_SRC := $(wildcard server/image/*.c)
IMAGE_LIBRARY_SRC := $(wildcard server/image/*.cpp)
# Code that sheend shares with its worker programs, and code of the worker programs only; each has a main and tasks.
WORKER_SHARED_SRC := server/sandbox/stream.c server/sandbox/job.c server/sandbox/pass.c server/sandbox/filter.c \
                     server/sandbox/cage_code.c server/sandbox/image_code.c
ZYGOTE_SRC := server/sandbox/zygote.c server/sandbox/sandbox.c server/sandbox/threads.c server/sandbox/landlock.c
# The folders of the daemon only.
SERVICE_SRC := $(foreach room,net session frame assets output threads ops,$(wildcard server/$(room)/*.c))
CLIENT_LIB_SRC := $(wildcard client/lib/*.c client/lib/*/*.c)
CLIENT_CLI_SRC := $(wildcard client/cli/*.c client/cli/*/*.c)
CLIENT_SRC := $(CLIENT_LIB_SRC) $(CLIENT_CLI_SRC)
SHADERS := $(sort $(wildcard shaders/*.glsl))

PROTOCOL_OBJ := $(call obj,$(PROTOCOL_SRC)) $(BUILD)/obj/gen/sheen.pb.c.o
CORE_OBJ := $(call obj,$(CAGE_SRC) $(SURFACE_SRC) server/base/error.c)
# The shader programs that run on processors; shaders/lanes translates them to C++.
NATIVE_PROGRAMS := $(shell sed -nE 's/^(native|both) +([a-z_]+) .*/\2/p' shaders/programs)
LANES_OBJ := $(foreach set,$(LANE_SETS),$(patsubst %.c,$(BUILD)/obj/%.$(set).o,$(LANES_SRC)) \
             $(patsubst %,$(BUILD)/obj/gen/lanes/%.$(set).o,$(NATIVE_PROGRAMS)))
RENDER_OBJ := $(LANES_OBJ) $(call obj,$(SCENE_SRC) $(RENDER_SRC) server/base/processors.c protocol/control_group.c protocol/ranges.c) $(BUILD)/obj/gen/shaders.c.o
SERVER_OBJ := $(call obj,$(filter-out server/base/error.c,$(wildcard server/base/*.c)) $(SERVICE_SRC) $(CONVERT_SRC) $(CURVES_SRC)) $(RENDER_OBJ) $(CORE_OBJ) \
              $(call obj,$(IMAGE_SRC) $(WORKER_SHARED_SRC) server/sandbox/confine.c) $(PROTOCOL_OBJ)
# With sanitizers, drivers stay loaded until the end, so that the leak checker finds their memory.
KEEP_MODULES := $(if $(SANITIZE),$(call obj,tests/service/keep_modules.c))
SERVER_OBJ += $(KEEP_MODULES)
# Code that parses files of clients: linked into the worker programs only.
CAGE_TASKS_OBJ := $(call obj,$(CAGE_READ_SRC) server/sandbox/cage_tasks.c)
IMAGE_TASKS_OBJ := $(call obj,$(IMAGE_LIBRARY_SRC) server/sandbox/image_tasks.c)
WORKER_OBJ := $(call obj,server/base/error.c server/sandbox/stream.c server/sandbox/job.c server/sandbox/pass.c server/sandbox/filter.c $(ZYGOTE_SRC))
CAGE_WORKER_OBJ := $(call obj,server/sandbox/cage_main.c $(CAGE_SRC) server/sandbox/cage_code.c) \
                   $(CAGE_TASKS_OBJ) $(WORKER_OBJ)
IMAGE_WORKER_OBJ := $(call obj,server/sandbox/image_main.c $(IMAGE_SRC) server/sandbox/image_code.c) \
                    $(IMAGE_TASKS_OBJ) $(WORKER_OBJ)
# libsheen and the command. Both contain the protocol's code for texts and numbers, because libsheen exports only
# what sheen.h declares.
LIBSHEEN_OBJ := $(call obj,$(CLIENT_LIB_SRC)) $(PROTOCOL_OBJ)
$(LIBSHEEN_OBJ): CFLAGS += -fPIC -fvisibility=hidden
$(LIBSHEEN_OBJ): Makefile # objects of before had no such flags
CLI_OBJ := $(call obj,$(CLIENT_CLI_SRC) protocol/number.c protocol/ranges.c protocol/text.c)

SERVER_LIBS := -lepoxy -lprotobuf-nanopb -lzstd -lz -lturbojpeg -lssl -lcrypto -linih -lm
CAGE_WORKER_LIBS := -ltinygltf -lm
IMAGE_WORKER_LIBS := -lOpenImageIO -lOpenImageIO_Util -lm
LIBSHEEN_LIBS := -lprotobuf-nanopb -ljansson -lzstd -lssl -lcrypto -lm
CLIENT_LIBS := $(LIBSHEEN_LIBS) -lpng
TEST_LIBS := $(SERVER_LIBS) $(CAGE_WORKER_LIBS) $(IMAGE_WORKER_LIBS) -lpng -ljansson

.PHONY: all
PROGRAMS := $(BUILD)/sheend $(BUILD)/sheend-cage $(BUILD)/sheend-image $(BUILD)/sheen
LIBRARIES := $(BUILD)/libsheen.so.0 $(BUILD)/libsheen.a
MANUAL := $(BUILD)/manual/made
PACKAGE := $(BUILD)/python/made
all: $(PROGRAMS) $(LIBRARIES) $(MANUAL) $(PACKAGE)

$(BUILD)/sheend: $(SERVER_OBJ)
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(SERVER_LIBS)
$(BUILD)/sheend-cage: $(CAGE_WORKER_OBJ)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) -o $@ $^ $(CAGE_WORKER_LIBS)
$(BUILD)/sheend-image: $(IMAGE_WORKER_OBJ)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) -o $@ $^ $(IMAGE_WORKER_LIBS)
# The command contains libsheen, so that it can be copied anywhere and needs no library path.
$(BUILD)/sheen: $(CLI_OBJ) $(BUILD)/libsheen.a
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CLIENT_LIBS)
$(BUILD)/libsheen.so.0: $(LIBSHEEN_OBJ) client/lib/sheen.map
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -shared -Wl,-soname,libsheen.so.0 -Wl,--version-script=client/lib/sheen.map \
	    $(if $(SANITIZE),,-Wl,-z,defs) -o $@ $(LIBSHEEN_OBJ) $(LIBSHEEN_LIBS)
# A single object whose hidden names are local, so that they do not clash with names of a program.
$(BUILD)/obj/libsheen.o: $(LIBSHEEN_OBJ)
	$(Q)$(LD) -r -o $@ $^ && objcopy --localize-hidden $@
$(BUILD)/libsheen.a: $(BUILD)/obj/libsheen.o
	$(call say,AR $@)
	$(Q)rm -f $@ && ar rcsD $@ $^

# Two programs that contain the tables of options write the manual pages and completions. They are not installed,
# so that sheen and sheend need no option that only the build would use.
MANUAL_SHARED := $(call obj,$(patsubst %,deploy/manual/%.c,page shell output))
$(BUILD)/sheen-pages: $(call obj,deploy/manual/sheen_pages.c) $(MANUAL_SHARED) \
                      $(filter-out %/cli/main.c.o,$(CLI_OBJ)) $(BUILD)/libsheen.a
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CLIENT_LIBS)
$(BUILD)/sheend-pages: $(call obj,deploy/manual/sheend_pages.c) $(MANUAL_SHARED) $(filter-out %/ops/main.c.o,$(SERVER_OBJ))
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(SERVER_LIBS)
$(MANUAL): $(BUILD)/sheen-pages $(BUILD)/sheend-pages
	@mkdir -p $(@D)
	$(call say,MAN $(@D))
	$(Q)rm -f $(@D)/* && $(BUILD)/sheen-pages $(DATE) $(@D) && $(BUILD)/sheend-pages $(DATE) $(@D) && touch $@

# The Python package, whose messages are made from the files of the protocol, and a wheel of it.
$(PACKAGE): $(wildcard client/python/*.py client/python/sheen/*) protocol/sheen.proto protocol/sheen.options protocol/README.md Makefile
	$(call say,PY $(@D)/sheen)
	$(Q)PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 client/python/package.py $(VERSION) $(@D) && touch $@

$(BUILD)/obj/gen/%.c.o: $(BUILD)/gen/%.c
	@mkdir -p $(@D)
	$(call say,CC $<)
	$(Q)$(CC) $(filter-out -Wundef -Wmissing-prototypes,$(CFLAGS)) -c -o $@ $<
$(BUILD)/obj/%.c.o: %.c | $(GEN)
	@mkdir -p $(@D)
	$(call say,CC $<)
	$(Q)$(CC) $(CFLAGS) -c -o $@ $<
# With g++ alone, a header that many files include is parsed once for them, because parsing it takes a third of the
# compiler's time; with ccache not, because ccache would then keep nothing. The code is equal either way, so objects do not
# become old when such a parsed header appears, and `make install` needs none.
PARSED_ONCE := $(and $(filter g++,$(CXX)),$(if $(filter ccache,$(CXX))$(filter install,$(MAKECMDGOALS)),,yes))
define parsed_once # folder, header, flags of those files
$(1)/parsed.hpp.gch: $(2)
	@mkdir -p $$(@D)
	$$(call say,CXX $(2) $$(notdir $(1)))
	$$(Q)echo '#include "$(2)"' > $(1)/parsed.hpp && $$(CXX) $$(CXXFLAGS) $(3) -x c++-header -o $$@ $(1)/parsed.hpp
endef
# The flags of files that include it before all else.
use_parsed = $(if $(PARSED_ONCE),-I$(1) -include parsed.hpp)
# Compiles a source for one instruction set.
define lanes_of
$(eval $(call parsed_once,$(BUILD)/obj/gen/lanes/$(1),server/render/native/programs/glsl.hpp,$(LANES_FLAGS) $(LANES_CXXFLAGS) $(LANES_$(1)) -DLANE_SET=$(1)))
$(BUILD)/obj/%.$(1).o: %.c
	@mkdir -p $$(@D)
	$$(call say,CC $$< $(1))
	$$(Q)$$(CC) $$(CFLAGS) $$(LANES_FLAGS) $$(LANES_$(1)) -DLANE_SET=$(1) -c -o $$@ $$<
$(BUILD)/obj/gen/lanes/%.$(1).o: $(BUILD)/gen/lanes/%.cpp $(wildcard server/render/native/programs/*.h*) $(if $(PARSED_ONCE),| $(BUILD)/obj/gen/lanes/$(1)/parsed.hpp.gch)
	@mkdir -p $$(@D)
	$$(call say,CXX $$< $(1))
	$$(Q)$$(CXX) $$(CXXFLAGS) $(call use_parsed,$(BUILD)/obj/gen/lanes/$(1)) $$(LANES_FLAGS) $$(LANES_CXXFLAGS) $$(LANES_$(1)) -DLANE_SET=$(1) -c -o $$@ $$<
endef
$(foreach set,$(LANE_SETS),$(eval $(call lanes_of,$(set))))
$(BUILD)/obj/%.cpp.o: %.cpp | $(GEN)
	@mkdir -p $(@D)
	$(call say,CXX $<)
	$(Q)$(CXX) $(CXXFLAGS) -c -o $@ $<

$(BUILD)/gen/sheen.pb.c $(BUILD)/gen/sheen.pb.h &: protocol/sheen.proto protocol/sheen.options
	@mkdir -p $(@D)
	$(Q)$(NANOPB) -I protocol -D $(BUILD)/gen sheen.proto
.PRECIOUS: $(BUILD)/gen/lanes/%.cpp
$(BUILD)/gen/lanes/%.cpp: $(SHADERS) shaders/programs shaders/listed.py $(wildcard shaders/lanes/*)
	@mkdir -p $(@D)
	$(Q)CC="$(CC)" PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=shaders /usr/bin/python3 -m lanes $* > $@.part && mv $@.part $@
$(BUILD)/gen/shaders.c: $(SHADERS) shaders/programs shaders/listed.py shaders/embed.py
	@mkdir -p $(@D)
	$(Q)PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 shaders/embed.py $(SHADERS) > $@.part && mv $@.part $@
# A constant of a shader as the rows of a C array, so that server/render/native/rays/ask.c uses the same rays.
$(BUILD)/gen/edge_rays.inc: shaders/rounded.glsl shaders/lanes/constant.py shaders/lanes/parse.py
	@mkdir -p $(@D)
	$(Q)PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=shaders /usr/bin/python3 -m lanes.constant $< EDGE_RAYS > $@.part && mv $@.part $@

# A sheend with the faults of $SHEEN_FAULTS, which also counts the heap blocks that its own code (not that of
# libraries) takes. It is not installed.
$(BUILD)/sheend-faults: $(call obj,tests/service/faults.c tests/service/taken_over.c tests/service/allocations.c) $(filter-out %/server/base/fault.c.o,$(SERVER_OBJ))
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=strdup,--wrap=strndup,--wrap=limit_build_faces,--wrap=program_create -o $@ $^ $(SERVER_LIBS)

# --- tests ---------------------------------------------------------------------------------------
# Every test links everything except the two mains.
LIB_OBJ := $(filter-out %/server/ops/main.c.o $(KEEP_MODULES),$(SERVER_OBJ)) \
           $(CAGE_TASKS_OBJ) $(IMAGE_TASKS_OBJ) $(call obj,$(ZYGOTE_SRC)) $(filter-out %/client/cli/main.c.o,$(call obj,$(CLIENT_SRC)))
TEST_LIB := $(BUILD)/libtests.a
# Without symbols, because linking 150 programs with 20 MB of symbols each takes a minute. `make check TEST_LINK=` keeps them. gold, which is
# part of binutils too, takes half the processor time of the usual linker. The objects of tests hold lines and functions
# only (-g1): a link leaves their debug information out, and writing all of it takes a quarter of the compiler's time.
TEST_LINK := $(if $(FUZZ)$(COVERAGE),,-fuse-ld=gold $(if $(SANITIZE),,-Wl,--strip-debug))
$(BUILD)/obj/tests/%.o: BASE += $(if $(TEST_LINK),-g1)
# Unit tests and fuzz targets compute little in code of their own.
$(BUILD)/obj/tests/unit/%.o $(BUILD)/obj/tests/fuzz/%.o: BASE += $(if $(FUZZ)$(SANITIZE)$(COVERAGE),,-O1)
# The C++ of oracles and benchmarks, but that of a peer, which has flags of its own.
ifneq ($(PARSED_ONCE),)
STANDARD := $(BUILD)/obj/tests/parsed.hpp.gch
$(STANDARD): BASE += $(if $(TEST_LINK),-g1)
$(eval $(call parsed_once,$(BUILD)/obj/tests,tests/standard.hpp))
USE_STANDARD := $(call obj,$(filter-out tests/bench/embree.cpp,$(wildcard tests/oracle/*.cpp tests/bench/*.cpp)))
$(USE_STANDARD): | $(STANDARD)
$(USE_STANDARD): private CXXFLAGS += $(call use_parsed,$(BUILD)/obj/tests)
endif
$(TEST_LIB): $(LIB_OBJ)
	$(Q)rm -f $@ && ar rcsP $@ $^

UNIT_TESTS := $(patsubst tests/unit/%.c,$(BUILD)/tests/%,$(wildcard tests/unit/test_*.c))
ORACLE_SHARED := $(call obj,$(filter-out tests/oracle/test_%.cpp tests/oracle/fake_sheen.cpp,$(wildcard tests/oracle/*.cpp)))
# Not OpenImageIO: a program takes 0.7 s of a processor to load its 260 libraries.
ORACLE_LIBS := -losdCPU -lOpenEXR -lIex
$(call obj,tests/oracle/render.cpp tests/oracle/fake_sheen.cpp): CXXFLAGS += -isystem /usr/include/Imath
ORACLE_TESTS := $(patsubst tests/oracle/%.cpp,$(BUILD)/tests/%,$(wildcard tests/oracle/test_*.cpp) tests/oracle/fake_sheen.cpp)

$(BUILD)/tests/test_%: $(BUILD)/obj/tests/unit/test_%.c.o $(KEEP_MODULES) $(TEST_LIB) | $(PROGRAMS)
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) $(TEST_LINK) -o $@ $< $(KEEP_MODULES) $(TEST_LIB) -lcmocka $(TEST_LIBS)
# Hides libraries from the loader (tests/service/test_libraries.py).
$(BUILD)/tests/no_library.so: tests/service/no_library.c
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CC) -std=c11 -D_GNU_SOURCE $(CWARN) -O2 -fPIC -shared -o $@ $<
$(BUILD)/tests/test_threads_worker: | $(BUILD)/tests/bad_worker
$(BUILD)/tests/bad_worker: $(call obj,tests/worker/bad_worker.c) $(WORKER_OBJ)
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^
$(ORACLE_TESTS): $(BUILD)/tests/%: $(BUILD)/obj/tests/oracle/%.cpp.o $(ORACLE_SHARED) $(TEST_LIB)
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) $(TEST_LINK) -o $@ $< $(ORACLE_SHARED) $(TEST_LIB) $(ORACLE_LIBS) $(TEST_LIBS)

# Each fuzz target is linked with libFuzzer, or with a main that replays its corpus.
FUZZ_NAMES := $(patsubst tests/fuzz/fuzz_%.c,%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_TARGETS := $(patsubst %,$(BUILD)/tests/fuzz_%,$(FUZZ_NAMES))
FUZZ_SHARED := $(call obj,tests/fuzz/alloc_fail.c tests/fuzz/cage.c tests/fuzz/cplusplus.cpp \
               $(if $(FUZZ),,tests/fuzz/replay.c))
TINYGLTF := _ZN8tinygltf8TinyGLTF
TINYGLTF_LOAD := EPNS_5ModelEPNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEES9_PK
FUZZ_WRAPPED := malloc calloc realloc strdup strndup $(TINYGLTF)19LoadASCIIFromString$(TINYGLTF_LOAD)cjRKS8_j \
                $(TINYGLTF)20LoadBinaryFromMemory$(TINYGLTF_LOAD)hjRKS8_j
FUZZ_LINK := -Wl,--as-needed $(patsubst %,-Wl$(comma)--wrap=%,$(FUZZ_WRAPPED)) \
             $(if $(FUZZ),-fsanitize=fuzzer)
FUZZ_ARCHIVE := $(BUILD)/libfuzz.a
$(FUZZ_ARCHIVE): $(filter-out %/server/ops/main.c.o,$(SERVER_OBJ)) $(CAGE_TASKS_OBJ) \
                 $(call obj,$(filter-out client/cli/main.c,$(CLIENT_SRC)))
	$(Q)rm -f $@ && ar rcsP $@ $^
$(FUZZ_TARGETS): $(BUILD)/tests/fuzz_%: $(BUILD)/obj/tests/fuzz/fuzz_%.c.o $(FUZZ_SHARED) $(FUZZ_ARCHIVE)
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) $(TEST_LINK) $(FUZZ_LINK) -o $@ $^ $(CAGE_WORKER_LIBS) $(SERVER_LIBS) $(CLIENT_LIBS)
$(BUILD)/tests/fuzz_config: FUZZ_LINK += -Wl,--wrap=getaddrinfo

# Every question of the benchmarks is a file bench_NAME.cpp and a program, with the peers listed below.
BENCH_QUESTIONS := $(patsubst tests/bench/bench_%.cpp,%,$(wildcard tests/bench/bench_*.cpp))
BENCH := $(patsubst %,$(BUILD)/tests/bench_%,$(BENCH_QUESTIONS))
BENCH_MAIN := $(call obj,$(patsubst %,tests/bench/%.cpp,main bench timing sheet))
BENCH_LIBS := $(ORACLE_LIBS) $(TEST_LIBS)
# The peer is compiled as its users would do it, for this processor.
EMBREE_OBJ := $(call obj,tests/bench/embree.cpp)
$(EMBREE_OBJ): CXXFLAGS += -O3 -march=native -ffp-contract=fast
OSD_PATCHES_OBJ := $(call obj,tests/bench/osd_patches.cpp)
$(BUILD)/tests/bench_frame: $(call obj,$(patsubst %,tests/bench/%.cpp,frame_peers osd_drawing)) $(OSD_PATCHES_OBJ) $(EMBREE_OBJ)
$(BUILD)/tests/bench_frame: BENCH_LIBS := -losdGPU $(BENCH_LIBS) -lembree3
$(BUILD)/tests/bench_tables: $(call obj,tests/bench/tables_peers.cpp) $(OSD_PATCHES_OBJ)
$(BUILD)/tests/bench_png $(BUILD)/tests/bench_wire: $(call obj,tests/bench/daemon.cpp)
$(BENCH): $(BUILD)/tests/%: $(BUILD)/obj/tests/bench/%.cpp.o $(BENCH_MAIN) $(ORACLE_SHARED) $(TEST_LIB)
	@mkdir -p $(@D)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) $(TEST_LINK) -o $@ $(filter %.o,$^) $(TEST_LIB) $(BENCH_LIBS)

# The benchmarks of the renderer without peers, for a machine that has only EGL and libepoxy. The C++ runtime and
# jansson are linked statically.
SHEEN_BENCH_OBJ := $(call obj,$(patsubst %,tests/bench/bench_%.cpp,closeup frame light paper size tables)) \
                   $(BENCH_MAIN) \
                   $(call obj,tests/bench/no_peers.cpp tests/bench/no_gltf.c) \
                   $(call obj,$(patsubst %,tests/oracle/%.cpp,scene cage_file folder)) \
                   $(call obj,$(filter-out %.cpp,$(CAGE_READ_SRC)) server/base/arena.c server/base/fault.c server/base/block_cache.c server/base/clock.c server/ops/device_choice.c protocol/number.c) $(RENDER_OBJ) $(CORE_OBJ) \
                   $(KEEP_MODULES)
$(BUILD)/sheen-bench: $(SHEEN_BENCH_OBJ)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) -static-libstdc++ -static-libgcc -o $@ $^ -Wl,-Bstatic -ljansson -Wl,-Bdynamic -lepoxy -lm
sheen-bench: $(BUILD)/sheen-bench

# The native device for another processor is compiled and not linked, because the other libraries are this machine's.
native-units: $(LANES_OBJ) $(call obj,$(wildcard server/render/native/*.c server/render/native/frame/*.c server/render/native/clip/*.c server/render/native/polygons/*.c server/render/native/rays/*.c server/render/*.c))
arm64:
	$(MAKE) BUILD=build/arm64 CC="$(filter ccache,$(CC)) aarch64-linux-gnu-gcc" CXX="$(filter ccache,$(CXX)) aarch64-linux-gnu-g++" \
	    OPT=-O1 SYMBOLS= LANES_FLAGS="$(filter-out -O3,$(LANES_FLAGS)) -O1" native-units

.PHONY: tests test unit service oracle check soak fuzz fuzz-targets fuzz-coverage bench sheen-bench native-units arm64 lint format demo deps install wheel clean
# With sanitizers without benchmarks and most oracles (tests/README.md).
CHECKED_ORACLES := $(patsubst %,$(BUILD)/tests/test_%,random_cages breaks sectors)
tests: all $(BUILD)/sheend-faults $(BUILD)/tests/no_library.so $(UNIT_TESTS) $(FUZZ_TARGETS) \
       $(if $(SANITIZE),$(CHECKED_ORACLES),$(ORACLE_TESTS) $(BENCH) $(BUILD)/sheen-bench)
unit: all $(UNIT_TESTS) $(FUZZ_TARGETS)
	bash tests/run.sh unit $(BUILD)
service: all $(BUILD)/sheend-faults $(BUILD)/tests/no_library.so
	bash tests/run.sh service $(BUILD)
oracle: all $(ORACLE_TESTS)
	DEVICE=$(DEVICE) ISA=$(ISA) bash tests/run.sh oracle $(BUILD)
# Builds only what the named test needs: a unit program, a fuzz target, or what its kind needs.
test: all $(if $(wildcard tests/unit/$(T).c)$(filter fuzz_%,$(T)),$(BUILD)/tests/$(T),\
          $(if $(filter lanes,$(T)),,$(if $(filter service_%,$(T)),$(BUILD)/sheend-faults $(BUILD)/tests/no_library.so,$(ORACLE_TESTS))))
	bash tests/run.sh all $(BUILD) $(or $(T),$(error T=NAME: see tests/README.md))
check:
	$(MAKE) deps
	$(MAKE) -j$(JOBS) $(if $(SANITIZE),,lint arm64) tests
	bash tests/run.sh $(if $(SANITIZE),checked,all) $(BUILD)

fuzz-targets: $(FUZZ_TARGETS)
fuzz:
	sh deploy/deps.sh fuzz
	$(MAKE) FUZZ=1 fuzz-targets
	sh tests/fuzz/fuzz.sh build/fuzz $(SECONDS) $(FUZZ_NAMES)
	$(MAKE) SANITIZE=1 all
	SHEEN_FUZZ_S=$(SECONDS) /usr/bin/python3 tests/service/run.py build/sanitize test_sequences
	SHEEN_FUZZ_S=$(SECONDS) /usr/bin/python3 tests/service/run.py build/sanitize test_cages
fuzz-coverage:
	$(MAKE) COVERAGE=1 fuzz-targets
	sh tests/fuzz/coverage.sh build/coverage $(FUZZ_NAMES)

soak: all $(BUILD)/sheend-faults
	SHEEN_SOAK_S=$(SECONDS) /usr/bin/python3 tests/service/run.py $(BUILD) soak_load
	SHEEN_KILLS=34 /usr/bin/python3 tests/service/run.py $(BUILD) test_faults.Killed

# The programs run one after the other, because each needs the machine for itself.
bench: all $(BENCH) $(BUILD)/sheen-bench
	for bench in $(BENCH); do $$bench --runs $(RUNS) --folder $(BUILD)/bench || exit 1; done
	/usr/bin/python3 tests/bench/summary.py $(BUILD)/bench

lint:
	sh tests/lint.sh
format:
	clang-format -i $$(git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp' '*.hpp')

# --- for users -----------------------------------------------------------------------------------
demo:
	$(MAKE) deps
	$(MAKE) -j$(JOBS) all
	$(BUILD)/sheen render tests/models/fender.gltf -o $(BUILD)/demo.png
	@echo "The demo model's reflection lines are in $(BUILD)/demo.png"

deps:
	sh deploy/deps.sh

# Files that depend on PREFIX and LIBDIR are made in their final place, so that nothing is built again.
DEST := $(DESTDIR)$(PREFIX)
DEST_LIB := $(DESTDIR)$(LIBDIR)
install: all
	install -Dm755 -t $(DEST)/bin $(BUILD)/sheend $(BUILD)/sheen
	install -Dm755 -t $(DEST)/libexec/sheen $(BUILD)/sheend-cage $(BUILD)/sheend-image
	install -Dm644 $(BUILD)/libsheen.so.0 $(DEST_LIB)/libsheen.so.$(VERSION)
	ln -sf libsheen.so.$(VERSION) $(DEST_LIB)/libsheen.so.0
	ln -sf libsheen.so.0 $(DEST_LIB)/libsheen.so
	install -Dm644 -t $(DEST_LIB) $(BUILD)/libsheen.a
	install -Dm644 -t $(DEST)/include client/lib/sheen.h
	install -Dm644 -t $(DEST)/include/sheen client/lib/sheen/*.h
	install -Dm644 -t $(DESTDIR)$(PYTHONDIR)/sheen $(BUILD)/python/sheen/*.py $(BUILD)/python/sheen/py.typed
	install -Dm644 -t $(DESTDIR)$(PYTHONDIR)/sheen-$(VERSION).dist-info $(BUILD)/python/sheen-$(VERSION).dist-info/METADATA
	install -d $(DEST_LIB)/pkgconfig
	sed -e 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR:$(PREFIX)/%=$${prefix}/%)|; s|@VERSION@|$(VERSION)|' \
	    client/lib/sheen.pc.in > $(DEST_LIB)/pkgconfig/sheen.pc
	install -Dm644 -t $(DEST)/share/man/man1 $(BUILD)/manual/*.1
	install -Dm644 -t $(DEST)/share/man/man5 $(BUILD)/manual/*.5
	install -Dm644 -t $(DEST)/share/man/man8 $(BUILD)/manual/*.8
	for name in sheen sheend; do \
	    install -Dm644 $(BUILD)/manual/$$name.bash $(DEST)/share/bash-completion/completions/$$name || exit 1; done
	install -Dm644 -t $(DEST)/share/zsh/site-functions $(BUILD)/manual/_sheen $(BUILD)/manual/_sheend
	install -Dm644 -t $(DEST)/share/fish/vendor_completions.d $(BUILD)/manual/sheen.fish $(BUILD)/manual/sheend.fish
	install -d $(DEST)/lib/systemd/system
	sed 's|/usr/local/bin|$(PREFIX)/bin|' deploy/systemd/sheend.service > $(DEST)/lib/systemd/system/sheend.service
	install -m644 -t $(DEST)/lib/systemd/system deploy/systemd/sheend.socket deploy/systemd/sheend-metrics.socket
	install -Dm644 deploy/systemd/sheend.sysusers $(DEST)/lib/sysusers.d/sheend.conf
	install -Dm644 -t $(DEST)/share/doc/sheen deploy/systemd/sheend.conf

wheel: $(PACKAGE)
	@echo "$(BUILD)/python/sheen-$(VERSION)-py3-none-any.whl"

clean:
	rm -rf build

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)
