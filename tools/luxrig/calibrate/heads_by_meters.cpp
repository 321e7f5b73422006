#include "tools/luxrig/calibrate/heads_by_meters.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/calibration/head_meter_run.h"
#include "core/rig/zoom.h"
#include "tools/luxrig/calibrate/head_turner.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

using Clock = HeadTurner::Clock;
using Readings = std::vector<std::vector<double>>;

/// Below such a share of its light, a head is too dim for luxmeters.
constexpr double kDimmest = 1e-4;
/// From a head's arrival at an aim that it only comes through to the next order.
constexpr std::chrono::milliseconds kCameThrough{100};

class MeterHeads {
 public:
  MeterHeads(const Session& stated, DaemonRig& daemon, const std::stop_token& stop)
      : stated_(stated), daemon_(daemon), stop_(stop), turner_(stated.rig, daemon, stop) {
    for (const Luxmeter& meter : stated.rig.luxmeters) meters_.push_back({meter.position_world_m, meter.normal_world});
  }

  Result<MeasuredHead> measure(std::size_t fixture) {
    MeasuredHead measured{fixture, {}, 0};
    const auto begun = Clock::now();
    const Fixture& head = stated_.rig.fixtures[fixture];
    const Intensity intensity = intensity_at_beam(stated_.rig.luminaires[head.luminaire], head.joints.beam_rad);
    HeadMeterRun run(meters_, *intensity, *stated_.rays, turner_.setup(fixture, {}));
    turner_.begin();
    std::vector<double> dark_lx;
    while (!run.next().empty()) {
      auto lux = take(fixture, run.next());
      if (!lux) return tl::unexpected(lux.error());
      if (dark_lx.empty()) dark_lx = lux->front();
      // As at full level: limits may leave less.
      for (auto& at : *lux)
        for (std::size_t m = 0; m < at.size(); ++m) at[m] = dark_lx[m] + (at[m] - dark_lx[m]) / level_;
      run.take(*lux);
    }
    measured.result = run.result();
    measured.seconds = std::chrono::duration<double>(Clock::now() - begun).count();
    return measured;
  }

 private:
  /// Per step that is read, per luxmeter; NaN = no steady reading.
  Result<Readings> take(std::size_t fixture, const std::vector<HeadMeterRun::Step>& steps) {
    std::vector<std::size_t> read;
    for (std::size_t k = 0; k < steps.size(); ++k)
      if (steps[k].read) read.push_back(k);
    std::size_t next = 0;
    const auto found = daemon_.read_lights(
        read.size(),
        [&](std::size_t light) -> Result<bool> {
          for (; next <= read[light]; ++next) {
            const HeadMeterRun::Step& step = steps[next];
            const auto arrives =
                turner_.send(fixture, {step.joints.pan_rad, step.joints.tilt_rad, zoom_of(fixture)}, step.lit);
            if (!arrives) return tl::unexpected(arrives.error());
            // What is only come through need not be waited for as long as light that is read.
            const auto until = step.read ? *arrives : *arrives - HeadTurner::kObeys + kCameThrough;
            if (auto waited = turner_.wait_until(until); !waited) return tl::unexpected(waited.error());
          }
          if (!steps[read[light]].lit) return true;
          if (auto level = see_level(fixture); !level) return tl::unexpected(level.error());
          return true;
        },
        stop_);
    if (!found) return tl::unexpected(found.error());
    Readings lux;
    for (const auto& of_light : *found) {
      lux.emplace_back();
      for (const auto& reading : of_light) lux.back().push_back(reading ? reading->lux : NAN);
    }
    return lux;
  }

  Result<void> see_level(std::size_t fixture) {
    const auto level = daemon_.levels_now();
    if (!level) return tl::unexpected(level.error());
    level_ = std::max(kDimmest, (*level)[fixture]);
    return {};
  }
  [[nodiscard]] double zoom_of(std::size_t fixture) const { return stated_.rig.fixtures[fixture].joints.beam_rad; }

  const Session& stated_;
  DaemonRig& daemon_;
  std::stop_token stop_;
  HeadTurner turner_;
  std::vector<HeadMeter> meters_;
  double level_ = 1;  ///< at which the head is lit
};

}  // namespace

Result<std::vector<MeasuredHead>> measure_heads_by_meters(const Session& stated, DaemonRig& daemon,
                                                          const std::stop_token& stop) {
  std::vector<MeasuredHead> heads;
  const std::vector<std::size_t> fixtures = heads_of(stated.rig);
  if (fixtures.empty()) return heads;
  const std::vector<double> dark(stated.rig.fixtures.size(), 0.0);
  if (auto sent = daemon.light(dark, stop); !sent) return tl::unexpected(sent.error());
  MeterHeads measurer(stated, daemon, stop);
  const Progress progress = progress_line("turning heads");
  for (const std::size_t fixture : fixtures) {
    if (progress) progress(static_cast<double>(heads.size()) / static_cast<double>(fixtures.size()));
    auto head = measurer.measure(fixture);
    if (!head)
      return tl::unexpected(
          Fault{head.error().cause, "", stated.rig.fixtures[fixture].name + ": " + head.error().detail, {}});
    heads.push_back(std::move(*head));
  }
  return heads;
}

}  // namespace luxrig
