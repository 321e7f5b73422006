#pragma once
/// A show that holds its goals on a simulated rig under a stepped clock, with faults that no device reports.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/show/show_controller.h"
#include "sim/in_process_rig.h"

namespace luxrig {

class HeldRig {
 public:
  HeldRig(const Rig& rig, const LightModel& model, std::unique_ptr<sim::World> world);

  /// What is done to commands before they reach the lamps, and to readings before the show hears them.
  std::function<void(std::vector<LevelCommand>&)> on_the_way;
  std::function<void(LuxReading&)> as_read;
  /// From then on meters read this world's light: the same rig, with something knocked. Both are driven until then.
  void knock(std::unique_ptr<sim::World> knocked);
  void knocked_now() { reads_knocked_ = true; }

  void apply(std::span<const double> levels) { show_.apply(now_, levels); }
  void blackout(bool on) { show_.blackout(now_, on); }
  /// Runs for so long, or until so() is true; returns so().
  bool run(double seconds, const std::function<bool()>& so = {});
  /// Time in which nothing is looked at: the world goes on, the show neither hears nor sends anything.
  void rest(double seconds);
  /// After a rest: until meters show the light of now. The show still hears nothing.
  void wake();
  /// Seconds after which an alarm's text has all of these, if within so long.
  std::optional<double> told(double within_s, const std::vector<std::string>& parts);

  [[nodiscard]] ShowStatus status() const { return show_.status(now_); }
  [[nodiscard]] Phase phase() const { return show_.phase(); }
  [[nodiscard]] int corrections() const { return corrections_; }  ///< since the start
  [[nodiscard]] sim::World& world() { return (reads_knocked_ ? *knocked_ : devices_).world(); }
  [[nodiscard]] std::vector<double> levels() const;
  [[nodiscard]] double seconds() const { return to_seconds(now_.time_since_epoch()); }

 private:
  void tick();

  Rig rig_;
  sim::InProcessRig devices_;
  std::unique_ptr<sim::InProcessRig> knocked_;
  bool reads_knocked_ = false;
  ShowController show_;
  Time now_{}, stepped_{}, told_{};  ///< told_: of devices
  int corrections_ = 0;
};

}  // namespace luxrig
