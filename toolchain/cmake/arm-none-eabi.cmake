# Every target without an operating system on an Arm core uses arm-none-eabi-gcc with newlib-nano, and nothing that would ask a
# system for memory. A target's toolchain file sets BREAKAWAY_CPU_FLAGS and includes this one.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)  # an image needs a linker script, which a check of the compiler has not
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# -fno-threadsafe-statics: there are no threads, and the guard would pull in the runtime of C++. The last two leave the call
# graph with the stack use of every function beside its object, for toolchain/check_image.py.
set(CMAKE_CXX_FLAGS_INIT
  "${BREAKAWAY_CPU_FLAGS} -fno-exceptions -fno-rtti -fno-threadsafe-statics -ffunction-sections -fdata-sections \
-fstack-usage -fcallgraph-info=su")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -g -DNDEBUG" CACHE STRING "Flags of a release build")
# No system calls are linked (no nosys.specs): a call of malloc ends in the undefined _sbrk, and so in no image.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostartfiles --specs=nano.specs -Wl,--gc-sections")
