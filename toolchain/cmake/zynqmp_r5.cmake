# Toolchain of the target zynqmp_r5: Cortex-R5F of a Zynq UltraScale+, with the single-precision half of its FPU, so that
# double arithmetic would show as calls into the library. Needs the Debian packages gcc-arm-none-eabi,
# libnewlib-arm-none-eabi and libstdc++-arm-none-eabi-newlib. Usage: cmake --preset zynqmp_r5
set(BREAKAWAY_CPU_FLAGS "-mcpu=cortex-r5 -marm -mfpu=vfpv3xd -mfloat-abi=hard")
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
