# sheen's menu:
#   make            build/sheend, its workers build/sheend-cage and build/sheend-image, build/sheen
#   make demo       install what is missing, build, render the demo model to a PNG
#   make check      install what is missing, build, lint, run every test
#   make unit | oracle | service    one kind of test
#   make oracle     DEVICE=native|mesa|N ISA=v2|v3|v4: what the oracles judge (native, the widest)
#   make test       T=NAME: one row of what `make check` prints; tests/README.md says which there are
#   make fuzz       SECONDS=60: fuzz each target of tests/fuzz so long (needs clang-14: sh deploy/deps.sh fuzz), and a
#                   daemon with AddressSanitizer by sequences of messages
#   make fuzz-coverage   lines of protocol/, the readers and the workers' messages that the corpora reach
#   make soak       the service under load, SECONDS of each part (60), and 102 processes killed; prints
#                   figures, judges ratios
#   make bench      how fast, each question by a program of tests/bench, RUNS=9 of each; figures to
#                   build/bench, and at the end every ratio beside the last run's
#   make sheen-bench   the renderer's questions without peers, for a machine with EGL, libepoxy and no more
#   make arm64      compiles the native device for arm64, where vectors have 4 lanes; nothing runs there
#   make lint       format, static analysis, dependency rules
#   make format     let clang-format rewrite the sources
#   make deps       install Debian packages (needs root or sudo)
#   make install    PREFIX=/usr/local LIBDIR=PREFIX/lib DESTDIR=: programs, libsheen, manual pages, completions,
#                   systemd's units; builds nothing again
#   make clean
# SANITIZE=1 builds everything with AddressSanitizer and UBSan into build/sanitize, SANITIZE=thread
# with ThreadSanitizer into build/thread. FUZZ=1 and COVERAGE=1 are the builds of make fuzz and
# make fuzz-coverage.

VERSION := 0.1.0
# Of the manual pages: the version's day, so that equal sources give equal files.
DATE := 2026-11-30
PREFIX ?= /usr/local
LIBDIR ?= $(PREFIX)/lib
CC ?= gcc
CXX ?= g++
SANITIZE ?=
FUZZ ?=
COVERAGE ?=
SECONDS ?= 60
RUNS ?= 9
# Programs at work at once in `make check` and `make demo`.
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
# Guards of the stack and of jumps, as far as the compiler has them for its processor.
GUARDS := $(foreach flag,-fstack-clash-protection -fcf-protection,\
            $(shell $(CC) -Werror $(flag) -x c -S -o /dev/null /dev/null 2>/dev/null && echo $(flag)))
# No contraction: the tables must not depend on the processor that built them.
# Two folders give equal programs.
BASE := $(OPT) -g $(if $(COVERAGE),,-ffile-prefix-map=$(CURDIR)=.) -ffp-contract=off -fstack-protector-strong $(GUARDS) -D_FORTIFY_SOURCE=$(if $(FUZZ)$(SANITIZE)$(COVERAGE),0,2) \
        -I. -I$(BUILD)/gen -MMD -MP -DSHEEN_VERSION=\"$(VERSION)\" -pthread
CFLAGS += -std=c11 -D_GNU_SOURCE $(CWARN) $(BASE)
# The check of vptr makes a pipe, which workers may not.
# GCC 12 takes std::regex under a sanitizer for uninitialised.
CXXFLAGS += -std=c++17 $(WARN) $(BASE) $(if $(SANITIZE),-fno-sanitize=vptr -Wno-maybe-uninitialized)
LDFLAGS += $(OPT) -pthread -Wl,-z,relro,-z,now

NANOPB := /usr/bin/python3 /usr/bin/nanopb_generator.py -q
GEN := $(BUILD)/gen/sheen.pb.h $(BUILD)/gen/sheen.pb.c $(BUILD)/gen/shaders.c $(BUILD)/gen/edge_rays.inc

# V=1 shows every command.
Q := $(if $(V),,@)
say = $(if $(V),,@echo '  $(1)')

obj = $(patsubst %,$(BUILD)/obj/%.o,$(1))
PROTOCOL_SRC := $(wildcard protocol/*.c)
CAGE_SRC := $(wildcard server/cage/*.c)
CAGE_READ_SRC := $(wildcard server/cage/build/*.c server/cage/read/*.c server/cage/read/gltf/*.c server/cage/read/gltf/*.cpp)
SURFACE_SRC := $(wildcard server/surface/*.c server/surface/topology/*.c server/surface/subdivision/*.c)
# Between messages and scenes: for those who speak to clients.
CONVERT_SRC := $(wildcard server/scene/scene_convert*.c)
SCENE_SRC := $(filter-out $(CONVERT_SRC),$(wildcard server/scene/*.c))
RENDER_SRC := $(wildcard server/render/*.c server/render/gl/*.c server/render/gl/*/*.c server/render/native/*.c server/render/native/frame/*.c server/render/native/polygons/*.c server/render/native/rays/*.c)
# Compiled once for each instruction set: its name, its lanes, and what tells the compiler.
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
# GCC 12 takes what its own intrinsics leave undefined on purpose for an error, and warns that vectors are passed
# in other registers than by older compilers: no function here is called from outside of its unit. -g1: lines and
# functions, since names of what a translator wrote help nobody, and take a quarter of the compiler's time.
# ThreadSanitizer ends every function by a handler of exceptions, which would need the runtime of C++ in sheend.
LANES_CXXFLAGS := $(if $(FUZZ)$(SANITIZE)$(COVERAGE),-O2) $(if $(SANITIZE),-fno-exceptions) -g1 -Wno-uninitialized -Wno-maybe-uninitialized -Wno-psabi -Wno-unused -Wno-unused-parameter -Wno-shadow
# Frames need not be the same bytes from one instruction set to the next.
LANES_FLAGS := $(if $(FUZZ)$(SANITIZE)$(COVERAGE),,-O3) -ffp-contract=fast -fno-math-errno -fno-trapping-math
IMAGE_SRC := $(wildcard server/image/*.c)
IMAGE_LIBRARY_SRC := $(wildcard server/image/*.cpp)
# What sheend shares with its workers, and what is theirs alone: each has a main and tasks.
WORKER_SHARED_SRC := server/sandbox/stream.c server/sandbox/job.c server/sandbox/pass.c server/sandbox/filter.c \
                     server/sandbox/cage_code.c server/sandbox/image_code.c
ZYGOTE_SRC := server/sandbox/zygote.c server/sandbox/sandbox.c server/sandbox/threads.c
# The rooms of the daemon alone.
SERVICE_SRC := $(foreach room,net session frame assets output threads ops,$(wildcard server/$(room)/*.c))
CLIENT_LIB_SRC := $(wildcard client/lib/*.c client/lib/*/*.c)
CLIENT_CLI_SRC := $(wildcard client/cli/*.c client/cli/*/*.c)
CLIENT_SRC := $(CLIENT_LIB_SRC) $(CLIENT_CLI_SRC)
SHADERS := $(sort $(wildcard shaders/*.glsl))

PROTOCOL_OBJ := $(call obj,$(PROTOCOL_SRC)) $(BUILD)/obj/gen/sheen.pb.c.o
CORE_OBJ := $(call obj,$(CAGE_SRC) $(SURFACE_SRC) server/base/error.c)
# The programs of shaders/ that run on processors, written as C++ by shaders/lanes.
NATIVE_PROGRAMS := $(shell sed -nE 's/^(native|both) +([a-z_]+) .*/\2/p' shaders/programs)
LANES_OBJ := $(foreach set,$(LANE_SETS),$(patsubst %.c,$(BUILD)/obj/%.$(set).o,$(LANES_SRC)) \
             $(patsubst %,$(BUILD)/obj/gen/lanes/%.$(set).o,$(NATIVE_PROGRAMS)))
RENDER_OBJ := $(LANES_OBJ) $(call obj,$(SCENE_SRC) $(RENDER_SRC) server/base/processors.c protocol/control_group.c protocol/ranges.c) $(BUILD)/obj/gen/shaders.c.o
SERVER_OBJ := $(call obj,$(filter-out server/base/error.c,$(wildcard server/base/*.c)) $(SERVICE_SRC) $(CONVERT_SRC)) $(RENDER_OBJ) $(CORE_OBJ) \
              $(call obj,$(IMAGE_SRC) $(WORKER_SHARED_SRC) server/sandbox/confine.c) $(PROTOCOL_OBJ)
# With sanitizers, drivers stay loaded until the end: the leak checker must find what they hold.
KEEP_MODULES := $(if $(SANITIZE),$(call obj,tests/service/keep_modules.c))
SERVER_OBJ += $(KEEP_MODULES)
# What parses files from strangers: linked into the workers alone.
CAGE_TASKS_OBJ := $(call obj,$(CAGE_READ_SRC) server/sandbox/cage_tasks.c)
IMAGE_TASKS_OBJ := $(call obj,$(IMAGE_LIBRARY_SRC) server/sandbox/image_tasks.c)
WORKER_OBJ := $(call obj,server/base/error.c server/sandbox/stream.c server/sandbox/job.c server/sandbox/pass.c server/sandbox/filter.c $(ZYGOTE_SRC))
CAGE_WORKER_OBJ := $(call obj,server/sandbox/cage_main.c $(CAGE_SRC) server/sandbox/cage_code.c) \
                   $(CAGE_TASKS_OBJ) $(WORKER_OBJ)
IMAGE_WORKER_OBJ := $(call obj,server/sandbox/image_main.c $(IMAGE_SRC) server/sandbox/image_code.c) \
                    $(IMAGE_TASKS_OBJ) $(WORKER_OBJ)
# libsheen and the command. What both need of the protocol's text and numbers is in each: libsheen shows
# nothing but what sheen.h declares.
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
all: $(PROGRAMS) $(LIBRARIES) $(MANUAL)

$(BUILD)/sheend: $(SERVER_OBJ)
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(SERVER_LIBS)
$(BUILD)/sheend-cage: $(CAGE_WORKER_OBJ)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) -o $@ $^ $(CAGE_WORKER_LIBS)
$(BUILD)/sheend-image: $(IMAGE_WORKER_OBJ)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) -o $@ $^ $(IMAGE_WORKER_LIBS)
# The command has libsheen inside: it starts wherever it is copied to, and asks no loader for a folder.
$(BUILD)/sheen: $(CLI_OBJ) $(BUILD)/libsheen.a
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(CLIENT_LIBS)
$(BUILD)/libsheen.so.0: $(LIBSHEEN_OBJ) client/lib/sheen.map
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -shared -Wl,-soname,libsheen.so.0 -Wl,--version-script=client/lib/sheen.map \
	    $(if $(SANITIZE),,-Wl,-z,defs) -o $@ $(LIBSHEEN_OBJ) $(LIBSHEEN_LIBS)
# One object, in which hidden names are local: they meet no name of a program's.
$(BUILD)/obj/libsheen.o: $(LIBSHEEN_OBJ)
	$(Q)$(LD) -r -o $@ $^ && objcopy --localize-hidden $@
$(BUILD)/libsheen.a: $(BUILD)/obj/libsheen.o
	$(call say,AR $@)
	$(Q)rm -f $@ && ar rcsD $@ $^

# Manual pages and completions, written by two programs that have the tables of options inside. Neither is
# installed: so sheen and sheend need no option that nobody but a build would use.
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

$(BUILD)/obj/gen/%.c.o: $(BUILD)/gen/%.c
	@mkdir -p $(@D)
	$(call say,CC $<)
	$(Q)$(CC) $(filter-out -Wundef -Wmissing-prototypes,$(CFLAGS)) -c -o $@ $<
$(BUILD)/obj/%.c.o: %.c | $(GEN)
	@mkdir -p $(@D)
	$(call say,CC $<)
	$(Q)$(CC) $(CFLAGS) -c -o $@ $<
# One unit for each instruction set.
define lanes_of
$(BUILD)/obj/%.$(1).o: %.c
	@mkdir -p $$(@D)
	$$(call say,CC $$< $(1))
	$$(Q)$$(CC) $$(CFLAGS) $$(LANES_FLAGS) $$(LANES_$(1)) -DLANE_SET=$(1) -c -o $$@ $$<
$(BUILD)/obj/gen/lanes/%.$(1).o: $(BUILD)/gen/lanes/%.cpp
	@mkdir -p $$(@D)
	$$(call say,CXX $$< $(1))
	$$(Q)$$(CXX) $$(CXXFLAGS) $$(LANES_FLAGS) $$(LANES_CXXFLAGS) $$(LANES_$(1)) -DLANE_SET=$(1) -c -o $$@ $$<
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
# A constant of a shader as the rows of a C array: server/render/native/rays/ask.c has the same places of rays.
$(BUILD)/gen/edge_rays.inc: shaders/rounded.glsl shaders/lanes/constant.py shaders/lanes/parse.py
	@mkdir -p $(@D)
	$(Q)PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=shaders /usr/bin/python3 -m lanes.constant $< EDGE_RAYS > $@.part && mv $@.part $@

# sheend that fails where $SHEEN_FAULTS asks it to, and counts what its own code (no library's) takes from
# the heap: what is installed cannot.
$(BUILD)/sheend-faults: $(call obj,tests/service/faults.c tests/service/taken_over.c tests/service/allocations.c) $(filter-out %/server/base/fault.c.o,$(SERVER_OBJ))
	$(call say,LD $@)
	$(Q)$(CC) $(LDFLAGS) -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=strdup,--wrap=strndup,--wrap=limit_build_faces -o $@ $^ $(SERVER_LIBS)

# --- tests ---------------------------------------------------------------------------------------
# Every test links everything but the two mains.
LIB_OBJ := $(filter-out %/server/ops/main.c.o $(KEEP_MODULES),$(SERVER_OBJ)) \
           $(CAGE_TASKS_OBJ) $(IMAGE_TASKS_OBJ) $(call obj,$(ZYGOTE_SRC)) $(filter-out %/client/cli/main.c.o,$(call obj,$(CLIENT_SRC)))
TEST_LIB := $(BUILD)/libtests.a
# 150 programs of 20 MB of symbols each take a minute to link. `make check TEST_LINK=` keeps the symbols. gold, which is
# part of binutils too, takes half the processor time of the usual linker. The objects of tests hold lines and functions
# only (-g1): a link leaves their debug information out, and writing all of it takes a quarter of the compiler's time.
TEST_LINK := $(if $(FUZZ)$(SANITIZE)$(COVERAGE),,-fuse-ld=gold -Wl,--strip-debug)
$(BUILD)/obj/tests/%.o: BASE += $(if $(TEST_LINK),-g1)
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
# Hides libraries from the loader: tests/service/test_libraries.py.
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

# Each target with libFuzzer, or with a main that replays its corpus.
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

# Every question of the benchmarks is one bench_NAME.cpp, and a program with the peers it names.
BENCH_QUESTIONS := $(patsubst tests/bench/bench_%.cpp,%,$(wildcard tests/bench/bench_*.cpp))
BENCH := $(patsubst %,$(BUILD)/tests/bench_%,$(BENCH_QUESTIONS))
BENCH_MAIN := $(call obj,$(patsubst %,tests/bench/%.cpp,main bench timing sheet))
BENCH_LIBS := $(ORACLE_LIBS) $(TEST_LIBS)
# The peer gets what its users would give it: all of this processor.
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

# The questions of the renderer without peers, for a machine that has EGL, libepoxy and nothing
# else. What is in C++ brings its runtime along.
SHEEN_BENCH_OBJ := $(call obj,$(patsubst %,tests/bench/bench_%.cpp,closeup frame light paper size tables)) \
                   $(BENCH_MAIN) \
                   $(call obj,tests/bench/no_peers.cpp tests/bench/no_gltf.c) \
                   $(call obj,$(patsubst %,tests/oracle/%.cpp,scene cage_file folder)) \
                   $(call obj,$(filter-out %.cpp,$(CAGE_READ_SRC)) server/base/arena.c server/base/fault.c server/base/block_cache.c server/base/clock.c server/ops/device_choice.c protocol/number.c) $(RENDER_OBJ) $(CORE_OBJ) \
                   $(KEEP_MODULES)
$(BUILD)/sheen-bench: $(SHEEN_BENCH_OBJ)
	$(call say,LD $@)
	$(Q)$(CXX) $(LDFLAGS) -static-libstdc++ -static-libgcc -o $@ $^ -lepoxy -lm
sheen-bench: $(BUILD)/sheen-bench

# The native device for another processor, compiled and not linked: the libraries of the rest are this machine's.
native-units: $(LANES_OBJ) $(call obj,$(wildcard server/render/native/*.c server/render/native/frame/*.c server/render/native/polygons/*.c server/render/native/rays/*.c server/render/*.c))
arm64:
	$(MAKE) BUILD=build/arm64 CC="$(filter ccache,$(CC)) aarch64-linux-gnu-gcc" CXX="$(filter ccache,$(CXX)) aarch64-linux-gnu-g++" \
	    OPT=-O1 LANES_FLAGS="$(filter-out -O3,$(LANES_FLAGS)) -O1" native-units

.PHONY: tests test unit service oracle check soak fuzz fuzz-targets fuzz-coverage bench sheen-bench native-units arm64 lint format demo deps install clean
tests: all $(BUILD)/sheend-faults $(BUILD)/tests/no_library.so $(UNIT_TESTS) $(ORACLE_TESTS) $(FUZZ_TARGETS) $(BENCH) $(BUILD)/sheen-bench
unit: all $(UNIT_TESTS) $(FUZZ_TARGETS)
	bash tests/run.sh unit $(BUILD)
service: all $(BUILD)/sheend-faults $(BUILD)/tests/no_library.so
	bash tests/run.sh service $(BUILD)
oracle: all $(ORACLE_TESTS)
	DEVICE=$(DEVICE) ISA=$(ISA) bash tests/run.sh oracle $(BUILD)
# A unit program and a corpus are built alone, what else tests need by the kind that the name tells.
test: all $(if $(wildcard tests/unit/$(T).c)$(filter fuzz_%,$(T)),$(BUILD)/tests/$(T),\
          $(if $(filter lanes,$(T)),,$(if $(filter service_%,$(T)),$(BUILD)/sheend-faults $(BUILD)/tests/no_library.so,$(ORACLE_TESTS))))
	bash tests/run.sh all $(BUILD) $(or $(T),$(error T=NAME: see tests/README.md))
check:
	$(MAKE) deps
	$(MAKE) -j$(JOBS) lint tests arm64
	bash tests/run.sh all $(BUILD)

fuzz-targets: $(FUZZ_TARGETS)
fuzz:
	sh deploy/deps.sh fuzz
	$(MAKE) FUZZ=1 fuzz-targets
	sh tests/fuzz/fuzz.sh build/fuzz $(SECONDS) $(FUZZ_NAMES)
	$(MAKE) SANITIZE=1 all
	SHEEN_FUZZ_S=$(SECONDS) /usr/bin/python3 tests/service/run.py build/sanitize test_sequences
fuzz-coverage:
	$(MAKE) COVERAGE=1 fuzz-targets
	sh tests/fuzz/coverage.sh build/coverage $(FUZZ_NAMES)

soak: all $(BUILD)/sheend-faults
	SHEEN_SOAK_S=$(SECONDS) /usr/bin/python3 tests/service/run.py $(BUILD) soak_load
	SHEEN_KILLS=34 /usr/bin/python3 tests/service/run.py $(BUILD) test_faults.Killed

# One after the other: each wants the machine for itself.
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

# What is installed knows PREFIX and LIBDIR, so these files are made where they go: nothing is built again.
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

clean:
	rm -rf build

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)
