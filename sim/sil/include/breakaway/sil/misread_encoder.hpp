// An encoder that errs, between a mechanism and its drive.
#pragma once

#include "breakaway/drive_emulator/mechanism.hpp"
#include "breakaway/model/encoder_error.hpp"

namespace breakaway::sil {

class MisreadEncoder final : public drive_emulator::Mechanism {
 public:
  // `truth` must outlive it. Throws InputError as model::EncoderError.
  MisreadEncoder(drive_emulator::Mechanism& truth, const model::EncoderErrorParameters& error)
      : truth_{truth}, error_{error} {}

  void advance_to(double time_s, const model::AppliedForce& force) override { truth_.advance_to(time_s, force); }
  void change_force(const model::AppliedForce& force) override { truth_.change_force(force); }
  double position_m() const override { return error_.read_m(truth_.position_m()); }

 private:
  drive_emulator::Mechanism& truth_;
  mutable model::EncoderError error_;  // each reading draws its own noise
};

}  // namespace breakaway::sil
