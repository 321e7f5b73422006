#pragma once
/// A dimmer channel with its lamp: drive in, share of full light out.

#include "core/rig/equipment.h"

namespace luxrig::sim {

struct DimmerTruth {
  DimmerCurve nominal = DimmerCurve::linear;
  double exponent = 1;         ///< > 0: the true curve is the nominal one raised to it
  bool of_drive = false;       ///< the true curve is the drive raised to it, whatever the nominal one
  double dead_band = 0;        ///< up to this drive there is no light, 0…1
  double tail = 0;             ///< the least light above it, 0…1
  double lag_s = 0;            ///< first-order
  double warm_up_share = 0;    ///< so much more light when cold
  double ageing_per_hour = 0;  ///< share of the light that is lost in an hour at full light
};

class Dimmer {
 public:
  explicit Dimmer(const DimmerTruth& truth) : truth_(truth) {}

  /// Clamped to 0…1; a NaN is ignored, as no wire can carry one.
  void set_drive(double drive);
  /// The lamp is burnt out or has no power: it goes dark with its lag, and returns to the last drive.
  void set_out(bool out);
  void step(double dt_s);

  [[nodiscard]] double drive() const { return out_ ? 0 : drive_; }                  ///< received by the lamp
  [[nodiscard]] double settled_level() const { return out_ ? 0 : settled_level_; }  ///< final value of level()
  /// Share of this lamp's own full light, warm and new; above 1 while it is cold.
  [[nodiscard]] double level() const { return level_ * condition_; }

 private:
  DimmerTruth truth_;
  double drive_ = 0, settled_level_ = 0, level_ = 0;
  double warmth_ = 0, hours_ = 0;  ///< 0 cold … 1 as after ten minutes at full light; at full light
  double condition_ = 1;           ///< light over that of a warm, new lamp
  double since_condition_s_ = 0;
  bool out_ = false;
};

}  // namespace luxrig::sim
