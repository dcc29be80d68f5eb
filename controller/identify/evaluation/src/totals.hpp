// What all samples of friction come to.
#pragma once

#include "breakaway/evaluation/identification.hpp"

namespace breakaway::evaluation {

// From rest to rest, in the order of time; a sample belongs to the motion that it is in.
void number_motions(Identification& found);

// The ranges that were seen, and bounds with the margins. Requires samples and a mass.
void sum_up(Identification& found, const Margins& margins);

// Friction takes energy, so it never comes out at 0 or below where nothing else pushes the axis. Throws InputError.
void require_friction(const Identification& found);

}  // namespace breakaway::evaluation
