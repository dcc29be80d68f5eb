// AxisParts: of what AxisController is made, for the kind of kicks that it gives. The choice is the compiler's, so that
// an axis carries and computes nothing of the kinds that it is not.
#pragma once

#include "breakaway/law/approach_plan.hpp"
#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/fine_stage.hpp"
#include "breakaway/law/kick_cycle.hpp"
#include "breakaway/law/shaped_move.hpp"
#include "breakaway/law/spring_stage.hpp"
#include "breakaway/law/work_aim.hpp"
#include "breakaway/law/work_cycle.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::law {

template <class Kicks>
struct AxisParts;

template <class Scalar>
struct AxisParts<BrakedKicks<Scalar>> {
  static constexpr Coast coast = Coast::brake;
  static constexpr bool by_work = false;
  using Cycle = KickCycle<Scalar>;
  using Aim = FineStage<Scalar>;
  using Plan = ApproachPlan<Scalar>;
};

template <class Scalar>
struct AxisParts<WorkKicks<Scalar>> {
  static constexpr Coast coast = Coast::work;
  static constexpr bool by_work = true;
  using Cycle = WorkCycle<Scalar>;
  using Aim = WorkAim<Scalar>;
  using Plan = ShapedMove<Scalar>;
};

}  // namespace breakaway::law
