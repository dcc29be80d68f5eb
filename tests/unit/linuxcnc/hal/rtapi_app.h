/* Of LinuxCNC's rtapi_app.h what the component uses. The parameters of the module are there for the test. */
#ifndef RTAPI_APP_H
#define RTAPI_APP_H

#define MODULE_AUTHOR(text)
#define MODULE_DESCRIPTION(text)
#define MODULE_LICENSE(text)
#define RTAPI_MP_STRING(name, text) char** const parameter_##name = &name;
#define RTAPI_MP_INT(name, text) int* const parameter_##name = &name;

#ifdef __cplusplus
extern "C" {
extern char** const parameter_image;
extern int* const parameter_count;
#endif

int rtapi_app_main(void);
void rtapi_app_exit(void);

#ifdef __cplusplus
}
#endif

#endif
