# Toolchain of the target stm32f405: Cortex-M4 with single-precision FPU. Needs the Debian packages gcc-arm-none-eabi,
# libnewlib-arm-none-eabi and libstdc++-arm-none-eabi-newlib. Usage: cmake --preset stm32f405
set(BREAKAWAY_CPU_FLAGS "-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard")
include("${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake")
