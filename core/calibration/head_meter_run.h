#pragma once
/// One head, calibrated by luxmeters alone: what to set next, and what follows from the readings. It neither sets nor
/// reads anything itself.
///
/// A meter shows the beam's middle by the aim at which it reads most (light_peak.h). The first meters are searched and
/// read one after the other; they tell roughly how the head hangs, so that the rings of aims around all others, in both
/// postures of the head, follow in one go: a late meter is then waited for once. What is kept for the test has to be hit
/// by the pose that the others gave.

#include <optional>
#include <span>
#include <vector>

#include "core/calibration/head_fit.h"
#include "core/calibration/head_places.h"
#include "core/calibration/light_peak.h"

namespace luxrig {

class HeadMeterRun {
 public:
  /// Lamp and head; what is not read is only come through.
  struct Step {
    Joints joints;
    bool lit = false, read = false;
  };
  /// meters: may be any number; those that the lamp does not light are left out. intensity: of the lamp at full level;
  /// it and rays must outlive this.
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
  enum class Part { dark, search, rings };
  struct Usable {
    std::size_t meter = 0;
    double peak_lx = 0;  ///< expected
  };
  struct Target {
    std::size_t usable = 0;
    bool flipped = false, held_out = false, tried = false;
    Joints centre{};  ///< of its ring
    int rounds = 0;
    std::vector<PeakSample> samples{};
    std::optional<LightPeak> peak{};
  };
  struct Aim {
    Joints joints;
    Approach from;
    std::size_t target = 0;
  };

  void choose_meters();
  void choose_targets();
  void go_on();
  [[nodiscard]] std::vector<Joints> search_aims_of(const Target& target) const;
  void search_on();
  void add_ring(std::size_t target, const Joints& centre);
  void add_aim(const Aim& aim);
  void end_of_rings();
  [[nodiscard]] std::optional<LightPeak> peak_of(Target& target) const;
  void trace_reflections(Target& target, const Joints& middle) const;
  [[nodiscard]] std::vector<HeadSighting> sightings(bool held_out) const;
  [[nodiscard]] std::size_t meters_seen(bool held_out) const;
  void refit();
  void end();
  [[nodiscard]] std::optional<std::string> why_refused() const;
  [[nodiscard]] const HeadMeter& meter_of(const Target& target) const { return meters_[usable_[target.usable].meter]; }
  [[nodiscard]] std::optional<Joints> towards(const HeadFit& fit, const Target& target) const;

  std::vector<HeadMeter> meters_;
  const IntensityDistribution& intensity_;
  const RayScene& rays_;
  HeadSetup setup_;
  BeamFall fall_;
  JointRange aims_within_;
  std::vector<Usable> usable_;
  std::vector<Target> targets_;
  std::vector<HeadFit> fits_;  ///< of all kinds, the best first
  std::vector<double> dark_lx_;
  Part part_ = Part::dark;
  std::vector<Joints> search_;  ///< aims to come, next last
  std::vector<Aim> read_;       ///< of the steps that are read
  Joints at_;
  int aims_ = 0, searched_ = 0;
  std::vector<Step> steps_;
  HeadResult result_;
};

}  // namespace luxrig
