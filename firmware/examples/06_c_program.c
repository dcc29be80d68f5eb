/* Example 6: the law in a program in C.
 *
 * The program owns the loop, the encoder and the drive; breakaway/law.h gives it a force for each position. What the law
 * is was certified on a PC and lies in this program as an array:
 *
 *   breakaway design sim/scenarios/braked_axis.toml --law-image axis_law.h
 *
 * The axis below is 1 kg on dry friction, 10 mm short of its target, followed in steps of 10 us. */
#include <math.h>
#include <stdio.h>

#include "axis_law.h"
#include "breakaway/law.h"

typedef struct {
  double position_m, velocity_m_s;
} axis_state;

/* Friction that the law is not told: it holds with up to 4.5 N and slides with 4.2 N. */
static void slide(axis_state* axis, double force_N, double time_s) {
  const double mass_kg = 1, static_N = 4.5, sliding_N = 4.2, step_s = 1e-5;
  for (double t = 0; t < time_s - step_s / 2; t += step_s) {
    if (axis->velocity_m_s == 0) {
      if (fabs(force_N) <= static_N) return;
      axis->velocity_m_s = copysign(1e-300, force_N);
    }
    const double before_m_s = axis->velocity_m_s;
    const double pushed_N = force_N - copysign(sliding_N, before_m_s);
    axis->velocity_m_s += pushed_N / mass_kg * step_s;
    if (before_m_s * axis->velocity_m_s <= 0) axis->velocity_m_s = 0; /* it turned, so it stops first */
    axis->position_m += (before_m_s + axis->velocity_m_s) / 2 * step_s;
  }
}

int main(void) {
  static breakaway_law_f law; /* not on the stack of a task: 6 KB, and it must stay where it is */
  const int result = breakaway_law_f_init(&law, sizeof law, BREAKAWAY_LAW_ABI, breakaway_law_image, sizeof breakaway_law_image, 0);
  if (result != BREAKAWAY_OK) {
    fprintf(stderr, "%s\n", breakaway_result_text(result));
    return 1;
  }
  breakaway_law_status status;
  breakaway_law_f_status(&law, &status);

  axis_state axis = {-0.01, 0};
  double acting_N = 0;
  for (int period = 0; period < 1000; ++period) {
    const double count_m = 1e-6;
    const float position_m = (float)(floor(axis.position_m / count_m) * count_m);
    const float force_N = breakaway_law_f_update(&law, position_m, true);
    const uint32_t kicks = status.kicks;
    breakaway_law_f_status(&law, &status);
    if (status.kicks > kicks) printf("%4d ms  %9.2f um  kick\n", period, 1e6 * axis.position_m);
    slide(&axis, acting_N, status.period_s); /* the force acts one period later */
    acting_N = (double)force_N;
  }
  printf("%4d ms  %9.2f um  %s, fault: %s\n", 1000, 1e6 * axis.position_m, breakaway_mode_name(status.mode),
         breakaway_fault_name(status.fault));
  return status.mode == BREAKAWAY_HOLD && fabs(axis.position_m) < 5e-6 ? 0 : 1;
}
