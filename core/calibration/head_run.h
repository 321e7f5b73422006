#pragma once
/// One head, calibrated by a camera: what to set next, and what follows from the pictures. It neither sets nor takes
/// anything itself, so it is the same on a stepped clock, in a program and in a test.
///
/// It first finds the beam, whichever way the head hangs, and moves pan and tilt a little to see which way they turn.
/// Then it aims at places chosen for what is least known of all aims, from both sides of each joint. A spot counts only
/// if it is gone when the lamp is off. At last it aims at places kept for the test: only a pose that hits them is
/// found.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/calibration/beam_spot.h"
#include "core/calibration/head_fit.h"
#include "core/calibration/head_places.h"

namespace luxrig {

/// Lamp and head for the next picture. Of a dark step, the picture may be taken while the head still turns; the next
/// step may be set when it is there. Of a lit step, when the head is there.
struct HeadStep {
  Joints joints;
  bool lit = false;
};

class HeadRun {
 public:
  /// surface and rays must outlive it. setup: speeds above 0.
  HeadRun(const SeenSurface& surface, const RayScene& rays, const HeadSetup& setup);

  /// nullopt = it has ended.
  [[nodiscard]] std::optional<HeadStep> next() const { return step_; }
  /// Asserts that it has not ended, and that the picture has the size of the surface.
  void take(const Picture& picture);
  /// Asserts that it has ended.
  [[nodiscard]] const HeadResult& result() const;
  [[nodiscard]] int aims() const { return aims_; }

 private:
  enum class Part { search, pan_probe, tilt_probe, spread, test };
  struct Aim {
    Joints joints;
    Approach from;
    std::optional<std::size_t> place{};
  };
  struct Sighted {
    BeamSpot spot;
    Aim aim;
    bool held_out = false;
    bool tells = true;  ///< sharp enough for the test
  };

  void take_lit(const Picture& picture);
  void confirm(const Picture& dark);
  void lose(NoBeam why);
  [[nodiscard]] std::optional<Aim> plan();
  [[nodiscard]] std::optional<Aim> probe(bool pan);
  [[nodiscard]] std::optional<Aim> most_informative() const;
  [[nodiscard]] std::optional<Aim> farthest_from_tried() const;
  void go_to(const std::optional<Aim>& aim);
  [[nodiscard]] std::vector<HeadSighting> sightings(bool held_out, const Vec3& pivot_world_m) const;
  [[nodiscard]] std::size_t count(bool held_out) const;
  void refit();
  void end();

  const SeenSurface& surface_;
  HeadSetup setup_;
  JointRange aims_within_;
  std::vector<HeadPlace> places_;
  std::vector<Joints> search_;
  std::vector<HeadFit> fits_;  ///< of the kinds that are left, the best first
  std::vector<Sighted> sighted_;
  std::vector<std::uint8_t> used_;  ///< per place
  std::vector<Joints> tried_;
  Part part_ = Part::search;
  std::size_t searched_ = 0;
  int probed_ = 0;  ///< ways of this probe that were tried
  int aims_ = 0, spread_ = 0, tested_ = 0;
  std::size_t first_ = 0;      ///< sighting that is probed from
  std::array<int, 6> lost_{};  ///< per NoBeam
  Aim aim_;
  bool waits_for_dark_ = false;  ///< the last sighting
  bool last_ = false;            ///< the step
  Picture dark_;
  std::optional<HeadStep> step_;
  HeadResult result_;
};

}  // namespace luxrig
