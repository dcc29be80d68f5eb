// What may go wrong on the bus, in the drives or at the encoders of axes that push each other, each by name.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "flashed_gantry.hpp"

namespace breakaway::emulated {

double between(FlashedGantry& g, double low, double high);
double decades(FlashedGantry& g, double low, double high);
bool coin(FlashedGantry& g);

// Of one axis, but for what is of the bus. A drive that hears is without force two periods after its stop; a deaf one
// once it was told by other means.
struct CoupledFault {
  std::string name;
  std::function<void(FlashedGantry&, std::size_t)> cause;
  bool of_the_bus = false;  // neither drive need hear
  bool deaf = false;        // its own drive may be
  bool encoder = false;     // the truth cannot be known while it lasts
};

std::vector<CoupledFault> coupled_faults();
// Ends all of them.
void mend(FlashedGantry& g);

}  // namespace breakaway::emulated
