/* Of LinuxCNC's hal.h what the component uses. */
#ifndef HAL_H
#define HAL_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { HAL_NAME_LEN = 47 };
typedef enum { HAL_IN = 16, HAL_OUT = 32 } hal_pin_dir_t;
typedef double hal_float_t;
typedef bool hal_bit_t;
typedef int hal_s32_t;
typedef unsigned hal_u32_t;

int hal_init(const char* name);
int hal_ready(int component);
int hal_exit(int component);
void* hal_malloc(long bytes);
int hal_pin_float_newf(hal_pin_dir_t, hal_float_t** pin, int component, const char* format, ...);
int hal_pin_bit_newf(hal_pin_dir_t, hal_bit_t** pin, int component, const char* format, ...);
int hal_pin_s32_newf(hal_pin_dir_t, hal_s32_t** pin, int component, const char* format, ...);
int hal_pin_u32_newf(hal_pin_dir_t, hal_u32_t** pin, int component, const char* format, ...);
int hal_export_funct(const char* name, void (*function)(void*, long), void* argument, int uses_fp, int reentrant,
                     int component);

#ifdef __cplusplus
}
#endif

#endif
