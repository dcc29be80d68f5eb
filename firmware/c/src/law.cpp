#include "breakaway/law.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <span>

#include "breakaway/firmware/law_image.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway {
namespace {

using firmware::FlashedAxis;
using firmware::LawImageKind;
using Bytes = std::span<const std::uint8_t>;

// A law with its numbers, which it points to.
template <class Scalar, class Kicks>
class OwnedLaw {
 public:
  // Nothing else of an axis is looked at.
  static breakaway_result checked(const FlashedAxis<Scalar, Kicks>& axis) noexcept {
    if (validate(axis.law) != law::ParameterError::none) return BREAKAWAY_LAW_INVALID;
    if (!firmware::internal::has_its_kicks(axis)) return BREAKAWAY_LAW_INVALID;
    return axis.certified ? BREAKAWAY_OK : BREAKAWAY_NOT_CERTIFIED;
  }

  explicit OwnedLaw(const FlashedAxis<Scalar, Kicks>& axis) noexcept
      : table_{axis.k3_table}, kicks_{axis.kicks}, controller_{axis.law, table_, kicks_} {}
  OwnedLaw(const OwnedLaw&) = delete;
  OwnedLaw& operator=(const OwnedLaw&) = delete;

  Scalar update(Scalar position_m, bool fresh) noexcept {
    const law::ControlOutput<Scalar> out = controller_.update({position_m - target_m_, Scalar{0}, fresh});
    mode_ = out.mode;
    return out.force_N;
  }
  void set_target(Scalar target_m) noexcept {
    if (!(target_m < target_m_ || target_m > target_m_)) return;
    controller_.shift_target(target_m - target_m_);
    target_m_ = target_m;
    mode_ = controller_.mode();
  }
  void reset() noexcept {
    controller_.reset();
    mode_ = controller_.mode();
  }

  breakaway_law_status status() const noexcept {
    return {.mode = static_cast<std::int32_t>(mode_),
            .fault = static_cast<std::int32_t>(controller_.fault()),
            .kicks = controller_.kicks(),
            .target_m = static_cast<double>(target_m_),
            .velocity_m_s = static_cast<double>(controller_.velocity_m_s()),
            .seen_friction_N = static_cast<double>(controller_.seen_friction_N()),
            .max_force_N = static_cast<double>(controller_.max_force_N()),
            .period_s = static_cast<double>(controller_.period_s()),
            .position_tolerance_m = static_cast<double>(promised_m())};
  }

 private:
  Scalar promised_m() const noexcept {
    const Scalar asked_m = controller_.parameters().position_tolerance_m;
    if constexpr (law::AxisParts<Kicks>::by_work)
      return asked_m;
    else
      return kicks_.promised_m(asked_m);
  }

  law::K3Table<Scalar> table_;
  Kicks kicks_;
  law::AxisController<Scalar, Kicks> controller_;
  Scalar target_m_ = 0;
  law::Mode mode_ = law::Mode::approach;  // of the newest force
};

// What lies in the caller's bytes. Zeros are a law that was not initialised.
template <class Scalar>
struct Object {
  using Rigid = OwnedLaw<Scalar, law::BrakedKicks<Scalar>>;
  using ByWork = OwnedLaw<Scalar, law::WorkKicks<Scalar>>;
  enum class Is : std::uint32_t { nothing = 0, rigid = 0x6272'6B01, by_work = 0x6272'6B02 };

  // First, so that a step begins where the caller points to.
  union {
    Rigid rigid;
    ByWork work;
  };
  Is is;
};

template <class Storage>
struct ScalarOf;
template <>
struct ScalarOf<breakaway_law_f> {
  using Type = float;
};
template <>
struct ScalarOf<breakaway_law_d> {
  using Type = double;
};
template <class Storage>
using ObjectIn = Object<typename ScalarOf<Storage>::Type>;
static_assert(sizeof(Object<float>) <= sizeof(breakaway_law_f) && alignof(Object<float>) <= alignof(breakaway_law_f));
static_assert(sizeof(Object<double>) <= sizeof(breakaway_law_d) && alignof(Object<double>) <= alignof(breakaway_law_d));

template <class Storage>
ObjectIn<Storage>& object_in(Storage& storage) noexcept {
  return *std::launder(reinterpret_cast<ObjectIn<Storage>*>(&storage));
}
template <class Storage>
const ObjectIn<Storage>& object_in(const Storage& storage) noexcept {
  return *std::launder(reinterpret_cast<const ObjectIn<Storage>*>(&storage));
}

// Calls `use` with the law that is there; returns `otherwise` where there is none.
template <class Object, class Use, class Result>
Result with_law(Object& object, Result otherwise, const Use& use) noexcept {
  if (object.is == Object::Is::rigid) return use(object.rigid);
  if (object.is == Object::Is::by_work) return use(object.work);
  return otherwise;
}

// The bytes of an axis' numbers, behind the number of entries of its kick table.
struct AxisBytes {
  LawImageKind kind = LawImageKind::rigid;
  std::uint8_t entries = 0;
  Bytes numbers;
};

breakaway_result find_axis(Bytes image, unsigned axis, AxisBytes& found) noexcept {
  using namespace firmware;
  if (image.size() < law_image_header_bytes + law_image_checksum_bytes ||
      std::memcmp(image.data(), law_image_magic.data(), law_image_magic.size()) != 0 || image[4] != law_image_version ||
      image[5] > static_cast<std::uint8_t>(LawImageKind::by_work))
    return BREAKAWAY_NO_LAW_IMAGE;
  const Bytes content = image.first(image.size() - law_image_checksum_bytes);
  if (checksum_of_bytes(content) != word_at(image.last<law_image_checksum_bytes>())) return BREAKAWAY_IMAGE_DAMAGED;
  if (axis >= image[6]) return BREAKAWAY_NO_SUCH_AXIS;
  Bytes rest = content.subspan(law_image_header_bytes);
  for (unsigned i = 0;; ++i) {
    if (rest.size() < 5) return BREAKAWAY_IMAGE_DAMAGED;
    const std::uint32_t size = word_at(rest.first<4>());
    rest = rest.subspan(4);
    if (size < 1 || size > rest.size()) return BREAKAWAY_IMAGE_DAMAGED;
    if (i == axis) {
      found = {static_cast<LawImageKind>(image[5]), rest[0], rest.subspan(1, size - 1)};
      return BREAKAWAY_OK;
    }
    rest = rest.subspan(size);
  }
}

template <class Scalar, class Kicks, class Law>
breakaway_result build(const AxisBytes& bytes, Law& place) noexcept {
  FlashedAxis<Scalar, Kicks> axis{};
  if (bytes.entries > axis.kicks.table.entries.size()) return BREAKAWAY_IMAGE_DAMAGED;
  axis.kicks.table.count = bytes.entries;
  firmware::LawImageReader reader{bytes.numbers};
  visit_law_numbers(axis, reader);
  if (!reader.read_all() || axis.kicks.table.count != bytes.entries) return BREAKAWAY_IMAGE_DAMAGED;
  const breakaway_result result = Law::checked(axis);
  if (result == BREAKAWAY_OK) new (&place) Law{axis};
  return result;
}

template <class Storage>
int init(Storage* storage, std::size_t law_bytes, unsigned abi, const void* image, std::size_t image_bytes,
         unsigned axis) noexcept {
  using Scalar = typename ScalarOf<Storage>::Type;
  using In = ObjectIn<Storage>;
  if (abi != BREAKAWAY_LAW_ABI) return BREAKAWAY_WRONG_ABI;
  if (storage == nullptr || image == nullptr) return BREAKAWAY_NULL_POINTER;
  if (law_bytes < sizeof(In)) return BREAKAWAY_STORAGE_TOO_SMALL;
  AxisBytes bytes;
  breakaway_result result = find_axis({static_cast<const std::uint8_t*>(image), image_bytes}, axis, bytes);
  if (result != BREAKAWAY_OK) return result;
  In& object = *reinterpret_cast<In*>(storage->bytes);
  const bool by_work = bytes.kind == LawImageKind::by_work;
  result = by_work ? build<Scalar, law::WorkKicks<Scalar>>(bytes, object.work)
                   : build<Scalar, law::BrakedKicks<Scalar>>(bytes, object.rigid);
  if (result == BREAKAWAY_OK) object.is = by_work ? In::Is::by_work : In::Is::rigid;
  return result;
}

template <class Object, class Scalar>
[[gnu::noinline]] Scalar update_by_work(Object& object, Scalar position_m, bool fresh) noexcept {
  return object.is == Object::Is::by_work ? object.work.update(position_m, fresh) : Scalar{0};
}

// What the interface adds to a step of the class is bounded by a test: one comparison for the usual kind.
template <class Storage, class Scalar>
Scalar update(Storage* storage, Scalar position_m, bool fresh) noexcept {
  ObjectIn<Storage>& object = object_in(*storage);
  if (object.is == ObjectIn<Storage>::Is::rigid) [[likely]]
    return object.rigid.update(position_m, fresh);
  return update_by_work(object, position_m, fresh);
}

template <class Storage, class Scalar>
int set_target(Storage* storage, Scalar target_m) noexcept {
  if (storage == nullptr) return BREAKAWAY_NULL_POINTER;
  if (!(std::abs(target_m) <= std::numeric_limits<Scalar>::max())) return BREAKAWAY_NOT_A_NUMBER;
  return with_law(object_in(*storage), BREAKAWAY_NOT_INITIALISED, [&](auto& law) {
    law.set_target(target_m);
    return BREAKAWAY_OK;
  });
}

template <class Storage>
int reset(Storage* storage) noexcept {
  if (storage == nullptr) return BREAKAWAY_NULL_POINTER;
  return with_law(object_in(*storage), BREAKAWAY_NOT_INITIALISED, [](auto& law) {
    law.reset();
    return BREAKAWAY_OK;
  });
}

template <class Storage>
int status(const Storage* storage, breakaway_law_status* status) noexcept {
  if (storage == nullptr || status == nullptr) return BREAKAWAY_NULL_POINTER;
  return with_law(object_in(*storage), BREAKAWAY_NOT_INITIALISED, [&](const auto& law) {
    *status = law.status();
    return BREAKAWAY_OK;
  });
}

}  // namespace
}  // namespace breakaway

extern "C" {

int breakaway_law_f_init(breakaway_law_f* law, size_t law_bytes, unsigned abi, const void* image, size_t image_bytes,
                         unsigned axis) {
  return breakaway::init(law, law_bytes, abi, image, image_bytes, axis);
}
int breakaway_law_d_init(breakaway_law_d* law, size_t law_bytes, unsigned abi, const void* image, size_t image_bytes,
                         unsigned axis) {
  return breakaway::init(law, law_bytes, abi, image, image_bytes, axis);
}
float breakaway_law_f_update(breakaway_law_f* law, float position_m, bool fresh) {
  return breakaway::update(law, position_m, fresh);
}
double breakaway_law_d_update(breakaway_law_d* law, double position_m, bool fresh) {
  return breakaway::update(law, position_m, fresh);
}
int breakaway_law_f_set_target(breakaway_law_f* law, float target_m) { return breakaway::set_target(law, target_m); }
int breakaway_law_d_set_target(breakaway_law_d* law, double target_m) { return breakaway::set_target(law, target_m); }
int breakaway_law_f_reset(breakaway_law_f* law) { return breakaway::reset(law); }
int breakaway_law_d_reset(breakaway_law_d* law) { return breakaway::reset(law); }
int breakaway_law_f_status(const breakaway_law_f* law, breakaway_law_status* status) {
  return breakaway::status(law, status);
}
int breakaway_law_d_status(const breakaway_law_d* law, breakaway_law_status* status) {
  return breakaway::status(law, status);
}

const char* breakaway_result_text(int result) {
  switch (result) {
    case BREAKAWAY_OK:
      return "done";
    case BREAKAWAY_NULL_POINTER:
      return "a pointer is null";
    case BREAKAWAY_WRONG_ABI:
      return "the program was compiled for another version of breakaway/law.h: compile it again with the header of "
             "this library";
    case BREAKAWAY_STORAGE_TOO_SMALL:
      return "the bytes given for the law are too few: give sizeof(breakaway_law_f) or sizeof(breakaway_law_d) of this "
             "header";
    case BREAKAWAY_NO_LAW_IMAGE:
      return "this is no law image that the library knows: write one with breakaway design FILE --law-image OUT";
    case BREAKAWAY_IMAGE_DAMAGED:
      return "the law image is damaged or was edited: write it again with breakaway design FILE --law-image OUT";
    case BREAKAWAY_NO_SUCH_AXIS:
      return "the law image has fewer axes: the first is number 0";
    case BREAKAWAY_NOT_CERTIFIED:
      return "the axis is not certified: breakaway design FILE says why";
    case BREAKAWAY_LAW_INVALID:
      return "a number of the law is out of its range: write the image again with breakaway design FILE --law-image "
             "OUT";
    case BREAKAWAY_NOT_A_NUMBER:
      return "the target is no finite number: nothing changed";
    case BREAKAWAY_NOT_INITIALISED:
      return "the law was not initialised: call breakaway_law_f_init or breakaway_law_d_init first, and look at its "
             "result";
    default:
      return "unknown result";
  }
}

// The names of the law are literals, which end with a zero.
const char* breakaway_mode_name(int mode) {
  return to_string(static_cast<breakaway::law::Mode>(mode < 0 || mode > 255 ? 255 : mode)).data();
}
const char* breakaway_fault_name(int fault) {
  return to_string(static_cast<breakaway::law::ControlFault>(fault < 0 || fault > 255 ? 255 : fault)).data();
}

}  // extern "C"
