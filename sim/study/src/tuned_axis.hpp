// An axis that is tuned: what it is, and its file with other gains.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/edited_file.hpp"
#include "breakaway/scenario/scenario.hpp"
#include "breakaway/study/friction_study.hpp"
#include "breakaway/study/tune.hpp"

namespace breakaway::study {

// As a file has it.
std::string quoted(law::Coast coast);

class TunedAxis {
 public:
  // Throws InputError as tune() does of a file that is not complete in what tuning does not choose.
  TunedAxis(std::string text, std::string name, std::string axis);

  const std::string& name() const { return name_; }
  const scenario::Scenario& scenario() const { return scenario_; }  // of this axis alone
  const config::Axis& axis() const { return scenario_.node.axes.front(); }
  const Gains& gains() const { return gains_; }  // that the file has, or some that it can have
  bool ideal() const { return scenario_.ideal(); }
  bool alone() const { return alone_; }  // in its file

  double distance_m() const { return distance_m_; }  // of the longest move
  Start start() const { return start_; }             // from which it leads to the target
  double fastest_m_s() const;   // speed that the force reaches in it under the least friction, half of it braking
  double allowed_m_s() const;   // of an approach, by what the file says
  double hardest_m_s2() const;  // acceleration of which the force is capable for certain

  // Of the file's run, or longer where an axis that settles in so long [s] would not settle in it.
  double duration_s(double settling_s) const;

  std::string text_with(const Gains& gains) const;
  std::string text_with(const Gains& gains, double duration_s) const;
  // Throws InputError where a file may not have such gains.
  scenario::Scenario with(const Gains& gains) const;
  // The same axis with numbers of its own set anew.
  TunedAxis changed(const std::vector<config::Setting>& settings) const;

 private:
  scenario::Scenario read(const std::string& text) const;
  scenario::Scenario read_to_be_tuned();
  double longest_move_m() const;

  std::string text_, name_, wanted_;
  bool alone_ = true;
  scenario::Scenario scenario_;
  Gains gains_;
  double distance_m_ = 0;
  Start start_;
};

}  // namespace breakaway::study
