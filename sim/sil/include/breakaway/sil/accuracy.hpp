// What an accuracy that is asked for leads to: the method that is taken, the error it makes, and what was refused.
//
// Error: the largest difference of a position (m, or rad) from the exact solution at the end of the run.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::sil {

// How a motion is followed.
struct Method {
  scenario::Integrator integrator = scenario::Integrator::event_driven;
  double step_s = 0;     // of time stepping
  double tolerance = 0;  // of the adaptive method, relative, for one step
};

// Returns "time_stepping with a step of 0.001 s", for people.
std::string to_string(const Method& method);

// A method that was tried on this motion.
struct MethodTrial {
  Method method;
  double error_m = 0;     // estimated; of time stepping the largest wherever in the first step the motion begins
  double estimate_m = 0;  // of the run as it is made, with its first step as long as the others
  double cost_s = 0;      // of a run, by its counts: see choose_method()
  bool holds = false;
};

// A method that cannot hold the accuracy, and why.
struct MethodRefusal {
  Method method;                                             // with the step that would be needed, where that is known
  std::string reason;                                        // one clause
  double cost_s = std::numeric_limits<double>::quiet_NaN();  // of the run that would be needed; NaN: none is known
  bool follows = true;                                       // what is asked for less accurately; false: not at all
};

struct Accuracy {
  double asked_m = 0;
  Method method;
  double error_estimate_m = 0;
  double cost_s = 0;  // of the run
  std::vector<MethodRefusal> refused;
  std::vector<MethodTrial> trials;  // in the order tried
};

// No method holds the accuracy. The text is one line with the cause, the estimated cost and the remedy.
class AccuracyRefused : public InputError {
 public:
  AccuracyRefused(const std::string& file, double asked_m, std::vector<MethodRefusal> refused);

  double asked_m() const { return asked_m_; }
  const std::vector<MethodRefusal>& refused() const { return refused_; }

 private:
  double asked_m_;
  std::vector<MethodRefusal> refused_;
};

// Returns "about 20 minutes", for people.
std::string cost_text(double cost_s);

}  // namespace breakaway::sil
