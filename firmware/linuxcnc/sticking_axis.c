/* An axis to try the component breakaway on: a mass on dry friction, an encoder of 1 um, a force that acts one period late.
 *
 *   loadrt sticking_axis
 *   addf sticking-axis.update servo-thread
 */
#include <math.h>

#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>

MODULE_AUTHOR("The breakaway authors");
MODULE_DESCRIPTION("A mass on dry friction");
MODULE_LICENSE("Apache-2.0");

static const double mass_kg = 1, static_N = 4.5, sliding_N = 4.2, count_m = 1e-6, step_s = 1e-5;

struct sticking_axis {
  hal_float_t *force, *position, *true_position;
  double acting_N, position_m, velocity_m_s;
};
static int component;

static void slide(struct sticking_axis* a, double time_s) {
  double t;
  for (t = 0; t < time_s - step_s / 2; t += step_s) {
    const double before_m_s = a->velocity_m_s;
    const double along = before_m_s != 0 ? before_m_s : a->acting_N;
    if (before_m_s == 0 && fabs(a->acting_N) <= static_N) return;
    a->velocity_m_s += (a->acting_N - copysign(sliding_N, along)) / mass_kg * step_s;
    if (before_m_s * a->velocity_m_s < 0) a->velocity_m_s = 0; /* it turned, so it stops first */
    a->position_m += (before_m_s + a->velocity_m_s) / 2 * step_s;
  }
}

static void update(void* argument, long period_ns) {
  struct sticking_axis* a = argument;
  slide(a, (double)period_ns * 1e-9);
  a->acting_N = *a->force;
  *a->true_position = a->position_m;
  *a->position = floor(a->position_m / count_m) * count_m;
}

static int make(void) {
  struct sticking_axis* a = hal_malloc(sizeof *a);
  int r;
  if (a == NULL) return -1;
  a->acting_N = a->position_m = a->velocity_m_s = 0;
  r = hal_pin_float_newf(HAL_IN, &a->force, component, "sticking-axis.force");
  if (r == 0) r = hal_pin_float_newf(HAL_OUT, &a->position, component, "sticking-axis.position");
  if (r == 0) r = hal_pin_float_newf(HAL_OUT, &a->true_position, component, "sticking-axis.true-position");
  return r == 0 ? hal_export_funct("sticking-axis.update", update, a, 1, 0, component) : r;
}

int rtapi_app_main(void) {
  int r;
  component = hal_init("sticking_axis");
  if (component < 0) return component;
  r = make();
  if (r != 0) {
    hal_exit(component);
    return r;
  }
  return hal_ready(component);
}

void rtapi_app_exit(void) { hal_exit(component); }
