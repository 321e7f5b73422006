#include "tools/luxrig/calibrate/head_motions.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "core/calibration/light_peak.h"
#include "core/rig/zoom.h"
#include "tools/luxrig/calibrate/head_turner.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

using Clock = HeadTurner::Clock;

constexpr double kNearestMeter_m = 0.5, kLeastCosine = 0.2, kLeastTilt_rad = rad_from_deg(15);
/// A short way and a long one, twice each, once from each side where the joint has the range. Short: the beam is off the
/// meter.
constexpr double kLongPan_rad = rad_from_deg(150), kLongTilt_rad = rad_from_deg(90);
constexpr double kShortBeams = 4;
constexpr int kSwitched = 2;
/// A head may be so much slower than its file says, and needs this beside.
constexpr double kSlower = 1.6, kBeside_s = 1.2;
constexpr double kDarkBefore_s = 0.6, kDarkSamples = 4;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

/// A luxmeter, the aim at it, and how far from there the light is half.
struct Station {
  std::size_t meter = 0;
  Joints aim;
  double half_lit_rad = 0, settled_s = 0, period_s = 0;
};

double half_angle_rad(const IntensityDistribution& intensity) {
  double angle_rad = 0;
  while (angle_rad < kPi / 4 &&
         intensity.intensity_cd(Vec3(std::sin(angle_rad), 0, -std::cos(angle_rad))) > intensity.max_intensity_cd() / 2)
    angle_rad += rad_from_deg(0.1);
  return angle_rad;
}

class MotionMeasurer {
 public:
  MotionMeasurer(const Session& stated, DaemonRig& daemon, const std::stop_token& stop)
      : stated_(stated), daemon_(daemon), turner_(stated.rig, daemon, stop) {}

  Result<HeadMotion> measure(const MeasuredHead& head) {
    const Fixture& fixture = stated_.rig.fixtures[head.fixture];
    const HeadSetup setup = turner_.setup(head.fixture, {});
    const auto station = station_of(head, setup);
    if (!station) return HeadMotion{};
    turner_.begin();
    const HeadVector& found = head.result.fit.pose.parameters;
    std::array<std::vector<LightReturn>, 2> moves;  // pan, tilt
    for (const bool pan : {true, false})
      for (const Joints& from : starts(*station, setup, pan)) {
        auto back = move(head.fixture, *station, from, pan ? fixture.pan_speed_rad_s : fixture.tilt_speed_rad_s);
        if (!back) return tl::unexpected(back.error());
        back->way_rad = pan ? std::abs((from.pan_rad - station->aim.pan_rad) * found[kHeadPanScale])
                            : std::abs((from.tilt_rad - station->aim.tilt_rad) * found[kHeadTiltScale]);
        back->half_lit_rad = station->half_lit_rad / (pan ? pan_share(station->aim) : 1);
        moves[pan ? 0 : 1].push_back(std::move(*back));
      }
    std::vector<LightReturn> switched;
    for (int k = 0; k < kSwitched; ++k) {
      auto back = move(head.fixture, *station, std::nullopt, 1);
      if (!back) return tl::unexpected(back.error());
      switched.push_back(std::move(*back));
    }
    return head_motion(moves[0], moves[1], switched);
  }

 private:
  std::optional<Station> station_of(const MeasuredHead& head, const HeadSetup& setup) const {
    const Rig& rig = stated_.rig;
    const Fixture& fixture = rig.fixtures[head.fixture];
    const HeadPose& pose = head.result.fit.pose;
    const JointRange range = with_run_up(setup.range);
    std::optional<Station> best;
    for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
      const Vec3 at_m = rig.luxmeters[m].position_world_m, to_m = at_m - pose.pivot_world_m();
      const auto timing = daemon_.timing(m);
      if (!timing || to_m.norm() < kNearestMeter_m ||
          -to_m.normalized().dot(rig.luxmeters[m].normal_world) < kLeastCosine ||
          stated_.rays->occluded(at_m, rig.luxmeters[m].normal_world, pose.pivot_world_m()))
        continue;
      const auto aim = pose.joints_towards(to_m, {0, 0}, range, {});
      if (!aim || std::abs(std::sin(aim->tilt_rad)) < std::sin(kLeastTilt_rad) || !may_aim(setup, *aim, {})) continue;
      const double slow_s = timing->settled_s + timing->period_s;
      if (best && slow_s >= best->settled_s) continue;
      const Intensity intensity = intensity_at_beam(rig.luminaires[fixture.luminaire], fixture.joints.beam_rad);
      best = Station{m, *aim, half_angle_rad(*intensity), slow_s, timing->period_s};
    }
    return best;
  }

  /// Where it comes back from: two ways, each from both sides if there is range.
  static std::vector<Joints> starts(const Station& station, const HeadSetup& setup, bool pan) {
    const double at_rad = pan ? station.aim.pan_rad : station.aim.tilt_rad;
    const double least_rad = pan ? setup.range.pan_min_rad : setup.range.tilt_min_rad;
    const double most_rad = pan ? setup.range.pan_max_rad : setup.range.tilt_max_rad;
    const double share = pan ? pan_share(station.aim) : 1;
    const double short_rad = kShortBeams * setup.beam_radius_rad / share;
    std::vector<Joints> from;
    const double room_rad = std::max(most_rad - at_rad, at_rad - least_rad);
    const double long_rad = std::min(room_rad, std::max(2 * short_rad, pan ? kLongPan_rad : kLongTilt_rad));
    for (const double wanted_rad : {short_rad, long_rad}) {
      std::vector<Joints> ways;
      for (const int side : {1, -1}) {
        Joints start = station.aim;
        (pan ? start.pan_rad : start.tilt_rad) = std::clamp(at_rad + side * wanted_rad, least_rad, most_rad);
        const double way_rad = std::abs((pan ? start.pan_rad : start.tilt_rad) - at_rad);
        if (way_rad > 0.95 * wanted_rad && !(setup.barred && setup.barred(start))) ways.push_back(start);
      }
      if (ways.size() == 1) ways.push_back(ways.front());
      from.insert(from.end(), ways.begin(), ways.end());
    }
    return from;
  }

  /// Off the meter and back; without a start, dark and lit again. Returns what the meter showed.
  Result<LightReturn> move(std::size_t fixture, const Station& station, const std::optional<Joints>& from,
                           double speed_rad_s) {
    const auto off = turner_.send(fixture, from.value_or(station.aim), from.has_value());
    if (!off) return tl::unexpected(off.error());
    const double way_rad =
        from ? std::max(std::abs(from->pan_rad - station.aim.pan_rad), std::abs(from->tilt_rad - station.aim.tilt_rad))
             : 0;
    const double slack_s = (kSlower - 1) * way_rad / speed_rad_s + kBeside_s + station.settled_s;
    if (auto waited = turner_.wait_until(*off + seconds(slack_s)); !waited) return tl::unexpected(waited.error());
    daemon_.forget_samples();
    if (auto waited =
            turner_.wait_until(Clock::now() + seconds(std::max(kDarkBefore_s, kDarkSamples * station.period_s)));
        !waited)
      return tl::unexpected(waited.error());
    LightReturn back;
    const double before_s = DaemonRig::clock_s();
    const auto there = turner_.send(fixture, station.aim, true);
    if (!there) return tl::unexpected(there.error());
    back.ordered_s = (before_s + DaemonRig::clock_s()) / 2;
    if (auto waited = turner_.wait_until(*there + seconds(slack_s)); !waited) return tl::unexpected(waited.error());
    back.samples = daemon_.samples(station.meter);
    return back;
  }

  const Session& stated_;
  DaemonRig& daemon_;
  HeadTurner turner_;
};

}  // namespace

Result<void> measure_motions(const Session& stated, DaemonRig& daemon, const std::stop_token& stop,
                             std::vector<MeasuredHead>& heads) {
  MotionMeasurer measurer(stated, daemon, stop);
  const Progress progress = progress_line("timing heads");
  for (std::size_t h = 0; h < heads.size(); ++h) {
    if (progress) progress(static_cast<double>(h) / static_cast<double>(heads.size()));
    if (heads[h].result.refused || stated.rig.fixtures[heads[h].fixture].axes) continue;
    auto motion = measurer.measure(heads[h]);
    if (!motion) return tl::unexpected(motion.error());
    heads[h].motion = *motion;
  }
  return {};
}

}  // namespace luxrig
