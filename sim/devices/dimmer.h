#pragma once
/// A dimmer channel with its lamp: drive in, share of full light out.

#include "core/rig/equipment.h"

namespace luxrig::sim {

class Dimmer {
 public:
  /// The true curve is the maker's nominal one raised to `exponent` (> 0); light follows it with a first-order lag.
  Dimmer(DimmerCurve nominal, double exponent, double lag_s) : nominal_(nominal), exponent_(exponent), lag_s_(lag_s) {}

  /// Clamped to 0…1; a NaN is ignored, as no wire can carry one.
  void set_drive(double drive);
  /// The lamp is burnt out or has no power: it goes dark with its lag, and returns to the last drive.
  void set_out(bool out);
  void step(double dt_s);

  [[nodiscard]] double drive() const { return out_ ? 0 : drive_; }                  ///< received by the lamp
  [[nodiscard]] double settled_level() const { return out_ ? 0 : settled_level_; }  ///< final value of level()
  [[nodiscard]] double level() const { return level_; }  ///< 0…1, share of this lamp's own full light

 private:
  DimmerCurve nominal_;
  double exponent_, lag_s_;
  double drive_ = 0, settled_level_ = 0, level_ = 0;
  bool out_ = false;
};

}  // namespace luxrig::sim
