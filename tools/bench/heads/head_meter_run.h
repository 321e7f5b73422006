#pragma once
/// One head, calibrated by luxmeters alone: what to set next, and what follows from the readings. It neither sets nor
/// reads anything itself.
///
/// A meter shows the beam's middle by the aim at which it reads most. About it, the logarithm of the light falls with
/// the square of the angle, ln E = c − k/2 · |q − q₀ ∓ b/2|², so that eight aims around it, four from each side of the
/// joints, tell the middle q₀ and the play b of the gears; the lamp's exact shape and the meter's gain do not matter, as
/// opposite aims share them. Meters are aimed at in both postures of the head. Three of them tell how it hangs; what is
/// kept for the test has to be hit by the pose that the others gave.

#include <optional>
#include <span>
#include <vector>

#include "core/calibration/head_fit.h"
#include "core/calibration/head_places.h"
#include "core/photometry/intensity.h"

namespace luxrig {

struct HeadMeter {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();
  double noise = 0.02;  ///< of a reading, relative
};

/// One aim around a maximum.
struct PeakSample {
  Joints sent;
  Approach from;
  double lux = 0;  ///< without the dark
};
/// The aim at which a meter reads most.
struct LightPeak {
  Joints middle;                  ///< without play
  Joints half_play;               ///< ≥ 0; beam_rad unused
  double standard_error_rad = 0;  ///< of the beam's direction, per axis
  double off_rad = 0;             ///< of the middle, from the samples' centre
  int used = 0;                   ///< samples that were bright enough to tell
};
/// How the logarithm of a beam's light falls where it is aimed beside a meter.
struct BeamFall {
  double radius_rad = 0;  ///< half angle at which the beam has a third of its peak
  double per_rad2 = 0;    ///< k above, there
};
/// By the lamp's file.
[[nodiscard]] BeamFall fall_of(const IntensityDistribution& intensity, double radius_rad);
/// None if the samples have no maximum.
[[nodiscard]] std::optional<LightPeak> light_peak(std::span<const PeakSample> samples, const Joints& centre,
                                                  const BeamFall& fall, double noise, double play_rad);

class HeadMeterRun {
 public:
  /// Lamp and head; what is not read is only come through.
  struct Step {
    Joints joints;
    bool lit = false, read = false;
  };
  /// meters: may be any number; those that the lamp does not light are left out. intensity: of the lamp at full level.
  HeadMeterRun(std::span<const HeadMeter> meters, const IntensityDistribution& intensity, const RayScene& rays,
               const HeadSetup& setup);

  /// Steps to take one after the other before anything is known of them: a meter that is late is waited for once.
  /// Empty = it has ended.
  [[nodiscard]] const std::vector<Step>& next() const { return steps_; }
  /// lux: per step that is read, per meter; NaN = no reading.
  void take(std::span<const std::vector<double>> lux);
  [[nodiscard]] const HeadResult& result() const;
  [[nodiscard]] int aims() const { return aims_; }

 private:
  enum class Part { dark, search, climb };
  struct Usable {
    std::size_t meter = 0;
    double peak_lx = 0;  ///< expected
  };
  struct Target {
    std::size_t usable = 0;
    bool flipped = false, held_out = false;
  };
  struct Aim {
    Joints joints;
    Approach from;
  };

  void choose_meters(const IntensityDistribution& intensity, const RayScene& rays);
  void choose_targets();
  void begin_target();
  void leave_target();
  void search_aims_of_target();
  void ring_around(Joints centre);  // a copy: it may be of ring_
  void add_steps(const Aim& aim);
  void search_on();
  void end_of_ring();
  [[nodiscard]] Joints brightest_middle();
  void refit();
  void end();
  [[nodiscard]] const HeadMeter& meter_of(const Target& target) const;
  [[nodiscard]] std::optional<Joints> towards(const HeadFit& fit, const Target& target) const;

  std::vector<HeadMeter> meters_;
  HeadSetup setup_;
  BeamFall fall_;
  JointRange aims_within_;
  std::vector<Usable> usable_;
  std::vector<Target> targets_;
  std::vector<std::optional<Joints>> found_of_usable_;  ///< unflipped posture
  std::vector<HeadFit> fits_;
  std::vector<HeadSighting> fitted_, held_out_;
  std::vector<std::size_t> fitted_meters_;  ///< per pair of sightings
  std::vector<double> dark_lx_;
  std::size_t target_ = 0;
  Part part_ = Part::dark;
  std::vector<Aim> search_, ring_;  ///< aims to come, next last; aims of the steps
  std::vector<PeakSample> samples_;
  Joints centre_, at_;
  int aims_ = 0, rounds_ = 0, searched_ = 0;
  std::vector<Step> steps_;
  HeadResult result_;
};

}  // namespace luxrig
