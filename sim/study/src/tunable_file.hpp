// The file of an axis that is tuned, whatever stands there for what tuning chooses.
#pragma once

#include <string>

namespace breakaway::study {

// Returns the text with gains, coast and tolerances of the axis of this name at values with which a file can be read,
// where its own are missing or contradict it: gains of any damping that the law can have, no tolerance that a reading
// cannot show, and the widest one where the file has a [run] settle_tolerance_m that one can. All else stays, and so
// does a file that is wrong elsewhere. `name` stands for the file in errors. Throws InputError where the text is no
// TOML, or no axis has that name.
std::string with_readable_choices(const std::string& text, const std::string& name, const std::string& axis);

}  // namespace breakaway::study
