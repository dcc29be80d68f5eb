// Numbers as a person would write them into a file.
#pragma once

namespace breakaway::config {

// Returns the value to so many significant digits, which is the double that they are read as. What has no more digits
// stays, in spite of roundings. Requires a finite value above 0.
double rounded_up(double value, int digits);
double rounded_down(double value, int digits);

}  // namespace breakaway::config
