// The sizes that are compiled once: two coordinates with two frictions, as in the example of van de Wouw & Leine, one
// and two coordinates with any frictions, and any size. Whoever needs another one compiles it from the header.
#include "breakaway/hybrid/event_driven.hpp"

namespace breakaway::hybrid {

template class WatchedMotion<2, 2>;
template class Segment<2, 2>;
template class HybridMachine<2, 2>;
template class HybridModes<2, 2>;
template class EventDriven<2, 2>;

template class WatchedMotion<1, Eigen::Dynamic>;
template class Segment<1, Eigen::Dynamic>;
template class HybridMachine<1>;
template class HybridModes<1>;
template class EventDriven<1>;

template class WatchedMotion<2, Eigen::Dynamic>;
template class Segment<2, Eigen::Dynamic>;
template class HybridMachine<2>;
template class HybridModes<2>;
template class EventDriven<2>;

template class WatchedMotion<Eigen::Dynamic, Eigen::Dynamic>;
template class Segment<Eigen::Dynamic, Eigen::Dynamic>;
template class HybridMachine<>;
template class HybridModes<>;
template class EventDriven<>;

}  // namespace breakaway::hybrid
