/* Of LinuxCNC's rtapi.h what the component uses. */
#ifndef RTAPI_H
#define RTAPI_H

#ifdef __cplusplus
extern "C" {
#endif

enum { RTAPI_MSG_ERR = 1 };
void rtapi_print_msg(int level, const char* format, ...);
int rtapi_snprintf(char* to, unsigned long bytes, const char* format, ...);

#ifdef __cplusplus
}
#endif

#endif
