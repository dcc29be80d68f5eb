/* A HAL component for LinuxCNC: the law of one axis or several, from a law image. README.md says how it is built and used.
 *
 *   loadrt breakaway image=/etc/breakaway/axis.law count=1
 *   addf breakaway.0.update servo-thread
 *
 * Nothing moves unless the image is whole and certified, the thread has the period of the law, and position and command
 * are connected: a pin that is connected to nothing is no number here, and that is a fault by name. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include <breakaway/law.h>
#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>

MODULE_AUTHOR("The breakaway authors");
MODULE_DESCRIPTION("Positions an axis with dry friction");
MODULE_LICENSE("Apache-2.0");

static char* image = "";
RTAPI_MP_STRING(image, "the law image, as breakaway design --law-image writes it");
static int count = 1;
RTAPI_MP_INT(count, "axes of the image, from the first on");

enum { most_axes = 8, most_image_bytes = 65536 };

/* Values of the pin fault-code, beside those of the law from 1 to 99. */
enum component_fault { no_position = 101, no_command = 102, wrong_period = 103 };

struct axis {
  hal_float_t *position, *command, *force, *velocity;
  hal_bit_t *enable, *reset, *fresh, *in_position, *fault;
  hal_s32_t *mode, *fault_code;
  hal_u32_t* kicks;
  hal_float_t* tolerance;
  int number;
  int own_fault; /* component_fault, until reset */
  bool was_enabled, was_reset;
  breakaway_law_status status;
  breakaway_law_d law;
};

static struct axis* axes;
static int component;
static unsigned char image_bytes[most_image_bytes];

static const char* text_of(int fault) {
  switch (fault) {
    case no_position:
      return "position is connected to nothing, or is no number: net it to the position of the encoder, in metres";
    case no_command:
      return "command is connected to nothing, or is no number: net it to the target, in metres";
    case wrong_period:
      return "the thread has another period than the law was designed for: give both the same, [loop] period_s of the file";
    default:
      return breakaway_fault_name(fault);
  }
}

/* Said once, as it happens. */
static void fail(struct axis* a, int fault) {
  if (a->own_fault == 0) {
    a->own_fault = fault;
    rtapi_print_msg(RTAPI_MSG_ERR, "breakaway.%d: %s\n", a->number, text_of(fault));
  }
}

static void take_reset(struct axis* a) {
  if (*a->reset && !a->was_reset) {
    a->own_fault = 0;
    breakaway_law_d_reset(&a->law);
    breakaway_law_d_status(&a->law, &a->status);
  }
  a->was_reset = *a->reset;
}

/* A thread whose period is off by more than a thousandth: the way of a kick goes with the square of it. */
static bool has_another_period(const struct axis* a, long period_ns) {
  return fabs((double)period_ns * 1e-9 - a->status.period_s) > 0.001 * a->status.period_s;
}

static double force_of(struct axis* a) {
  const bool begins = !a->was_enabled;
  const int fault_before = a->status.fault;
  double force_N;
  if (begins && fault_before == 0) breakaway_law_d_reset(&a->law);
  breakaway_law_d_set_target(&a->law, *a->command);
  force_N = breakaway_law_d_update(&a->law, *a->position, *a->fresh);
  breakaway_law_d_status(&a->law, &a->status);
  if (a->status.fault != 0 && fault_before == 0)
    rtapi_print_msg(RTAPI_MSG_ERR, "breakaway.%d: %s\n", a->number, text_of(a->status.fault));
  return force_N;
}

static void update(void* argument, long period_ns) {
  struct axis* a = argument;
  const bool enabled = *a->enable;
  double force_N = 0;
  take_reset(a);
  if (enabled) {
    if (has_another_period(a, period_ns)) fail(a, wrong_period);
    if (!isfinite(*a->position)) fail(a, no_position);
    if (!isfinite(*a->command)) fail(a, no_command);
    if (a->own_fault == 0) force_N = force_of(a);
  }
  a->was_enabled = enabled && a->own_fault == 0;
  *a->force = force_N;
  *a->velocity = a->status.velocity_m_s;
  *a->mode = a->own_fault != 0 ? BREAKAWAY_FAULT : a->status.mode;
  *a->fault_code = a->own_fault != 0 ? a->own_fault : a->status.fault;
  *a->fault = *a->fault_code != 0;
  *a->in_position = a->was_enabled && a->status.mode == BREAKAWAY_HOLD;
  *a->kicks = a->status.kicks;
}

static long read_image(void) {
  FILE* file;
  long bytes;
  if (image[0] == '\0') {
    rtapi_print_msg(RTAPI_MSG_ERR, "breakaway: no law image: say image=FILE, made by breakaway design --law-image FILE\n");
    return -EINVAL;
  }
  file = fopen(image, "rb");
  if (file == NULL) {
    rtapi_print_msg(RTAPI_MSG_ERR, "breakaway: image=%s cannot be opened: give its whole path, readable for this user\n", image);
    return -ENOENT;
  }
  bytes = (long)fread(image_bytes, 1, sizeof image_bytes, file);
  fclose(file);
  return bytes;
}

static int make_pins(struct axis* a) {
  const int n = a->number;
  int r = 0;
#define PIN(type, direction, member, name)                                                         \
  if (r == 0) r = hal_pin_##type##_newf(direction, &a->member, component, "breakaway.%d." name, n);
  PIN(float, HAL_IN, position, "position")
  PIN(float, HAL_IN, command, "command")
  PIN(bit, HAL_IN, enable, "enable")
  PIN(bit, HAL_IN, reset, "reset")
  PIN(bit, HAL_IN, fresh, "fresh")
  PIN(float, HAL_OUT, force, "force")
  PIN(float, HAL_OUT, velocity, "velocity")
  PIN(bit, HAL_OUT, in_position, "in-position")
  PIN(bit, HAL_OUT, fault, "fault")
  PIN(s32, HAL_OUT, fault_code, "fault-code")
  PIN(s32, HAL_OUT, mode, "mode")
  PIN(u32, HAL_OUT, kicks, "kicks")
  PIN(float, HAL_OUT, tolerance, "tolerance")
#undef PIN
  return r;
}

static int add_axis(struct axis* a, int number, size_t bytes) {
  char name[HAL_NAME_LEN + 1];
  int r;
  a->number = number;
  r = breakaway_law_d_init(&a->law, sizeof a->law, BREAKAWAY_LAW_ABI, image_bytes, bytes, (unsigned)number);
  if (r != BREAKAWAY_OK) {
    rtapi_print_msg(RTAPI_MSG_ERR, "breakaway: axis %d of %s: %s\n", number, image, breakaway_result_text(r));
    return -EINVAL;
  }
  breakaway_law_d_status(&a->law, &a->status);
  r = make_pins(a);
  if (r != 0) return r;
  *a->position = NAN; /* what a pin shows that is connected to nothing */
  *a->command = NAN;
  *a->fresh = 1;
  *a->tolerance = a->status.position_tolerance_m;
  rtapi_snprintf(name, sizeof name, "breakaway.%d.update", number);
  return hal_export_funct(name, update, a, 1, 0, component);
}

static int make_axes(void) {
  const long bytes = read_image();
  int i, r = 0;
  if (bytes < 0) return (int)bytes;
  if (count < 1 || count > most_axes) {
    rtapi_print_msg(RTAPI_MSG_ERR, "breakaway: count=%d must be 1 to %d\n", count, most_axes);
    return -EINVAL;
  }
  axes = hal_malloc((long)sizeof(struct axis) * count); /* never moved */
  if (axes == NULL) return -ENOMEM;
  memset(axes, 0, sizeof(struct axis) * (size_t)count);
  for (i = 0; i < count && r == 0; ++i) r = add_axis(&axes[i], i, (size_t)bytes);
  return r;
}

int rtapi_app_main(void) {
  int r;
  component = hal_init("breakaway");
  if (component < 0) return component;
  r = make_axes();
  if (r != 0) {
    hal_exit(component);
    return r;
  }
  return hal_ready(component);
}

void rtapi_app_exit(void) { hal_exit(component); }
