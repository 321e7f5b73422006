#include "tools/bench/hold/year.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/photometry/sky/daylight_availability.h"
#include "core/photometry/sky/sun_position.h"
#include "core/tasks/solve_tasks.h"
#include "tools/bench/hold/held_rig.h"

namespace luxrig {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kYearTruthError = 0.005;
constexpr int kDays = 365;
constexpr double kDay_s = 86400, kOpens_s = 10 * 3600, kCloses_s = 18 * 3600;
/// A show is looked at when the light at a meter has moved by as much as it corrects, and at least so often.
constexpr double kMeterMoved = 0.01, kLookEvery_s = 3600, kGlance_s = 60;
/// Three samples of a drift, and what corrects it.
constexpr double kLook_s = 6, kSettles_s = 30;
/// What a rooflight's blinds let through, on an open horizontal plane: what the file says, and what it is over that of
/// the sky.
constexpr double kStatedDaylight_lx = 60, kBlinds = 0.004;
constexpr double kLatitude_rad = rad_from_deg(52.5), kLongitude_rad = rad_from_deg(13.4);
/// A day's sky over the mean one.
constexpr double kDarkest = 0.4, kBrightest = 1.6;
/// Dust, as light that a lamp loses in an hour; and how far a meter's gain may go in a year.
constexpr double kDust_per_hour = 2e-5, kMeterDrift_per_year = 0.02;

sim::Deviations deviations_of_year(std::uint64_t seed) {
  sim::Deviations real = sim::Deviations::real();
  real.seed = seed;
  real.visits_per_hour = 0;
  real.ageing_per_hour += kDust_per_hour;
  real.meter_drift_per_hour = kMeterDrift_per_year / (kDays * 24);  // that of a day would be nine times the light
  return real;
}

/// True daylight over that of the rig file.
class DaylightOfYear {
 public:
  explicit DaylightOfYear(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (int day = 0; day <= kDays; ++day)
      sky_.push_back(kDarkest + (kBrightest - kDarkest) * static_cast<double>(random() >> 11) * 0x1p-53);
  }
  [[nodiscard]] double factor(double at_s) const {
    const double days = at_s / kDay_s;
    const auto day = std::min(static_cast<std::size_t>(days), sky_.size() - 2);
    UtcTime utc{2026, 1, 1, at_s / 3600 - 1};  // Central European Time
    const SunPosition sun = sun_position(utc, kLatitude_rad, kLongitude_rad);
    const double mean_lx = daylight_availability(CloudCover::overcast, sun.altitude_rad).sky_horizontal_lx;
    const double u = days - static_cast<double>(day);
    return (sky_[day] + u * (sky_[day + 1] - sky_[day])) * kBlinds * mean_lx / kStatedDaylight_lx;
  }

 private:
  std::vector<double> sky_;  ///< at midnight
};

/// Errors as shares, in steps of a thousandth.
class ErrorCounts {
 public:
  void add(double share) {
    const auto at = std::min(count_.size() - 1, static_cast<std::size_t>(std::abs(share) * 1000));
    ++count_[at];
    ++all_;
    worst_ = std::max(worst_, std::abs(share));
  }
  [[nodiscard]] double percentile(double share) const {
    double sum = 0;
    for (std::size_t k = 0; k < count_.size(); ++k)
      if ((sum += static_cast<double>(count_[k])) >= share * static_cast<double>(all_))
        return static_cast<double>(k + 1) / 1000;
    return 1;
  }
  [[nodiscard]] double worst() const { return worst_; }
  [[nodiscard]] std::string words() const {
    return fmt::format("{:.3f} / {:.3f} / {:.3f}", percentile(0.5), percentile(0.95), worst());
  }

 private:
  std::vector<std::uint64_t> count_ = std::vector<std::uint64_t>(2000);
  std::uint64_t all_ = 0;
  double worst_ = 0;
};

/// FNV-1a over the bits of numbers.
class Digest {
 public:
  void add(double number) {
    for (auto bits = std::bit_cast<std::uint64_t>(number), k = std::uint64_t{0}; k < 8; ++k, bits >>= 8)
      value_ = (value_ ^ (bits & 0xff)) * 0x100000001b3u;
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

class Year {
 public:
  Year(const Session& session, const LightModel& model, std::unique_ptr<sim::World> world, std::uint64_t seed)
      : rig_(session.rig), show_(session.rig, model, std::move(world)), daylight_(seed), metered_(rig_.points.size()) {
    for (const Luxmeter& meter : rig_.luxmeters)
      if (meter.point) metered_[*meter.point] = true;
  }

  void run(std::span<const double> plan, int days) {
    show_.apply(plan);
    show_.blackout(true);
    show_.run(1);
    for (int day = 0; day < days; ++day) {
      rest_until(day * kDay_s + kOpens_s);
      show_.blackout(false);
      settle();
      const double closes_s = day * kDay_s + kCloses_s;
      while (show_.seconds() + kGlance_s < closes_s) glance();
      rest_until(closes_s);
      show_.blackout(true);
      show_.run(1);
    }
  }

  ErrorCounts all, metered;
  double worst_of_limit = 0, kwh = 0;
  long looks = 0;
  Digest digest;
  [[nodiscard]] HeldRig& show() { return show_; }

 private:
  void rest_until(double at_s) {
    show_.rest(at_s - show_.seconds());
    show_.world().set_daylight(daylight_.factor(at_s));
  }
  void settle() {
    show_.run(kLook_s);
    show_.run(kSettles_s, [&] { return show_.phase() == Phase::holding; });
    seen_lx_ = meters_lx();
    looked_s_ = show_.seconds();
    ++looks;
  }
  void glance() {
    rest_until(show_.seconds() + kGlance_s);
    record();
    const std::vector<double> lux = meters_lx();
    bool moved = show_.seconds() - looked_s_ >= kLookEvery_s;
    for (std::size_t m = 0; m < lux.size(); ++m)
      moved = moved || std::abs(lux[m] - seen_lx_[m]) > kMeterMoved * seen_lx_[m];
    if (!moved) return;
    show_.wake();
    settle();
    record();
  }
  void record() {
    const auto points = show_.world().points();
    for (std::size_t p = 0; p < points.size(); ++p) {
      digest.add(points[p].lux);
      if (rig_.points[p].max_lx)
        worst_of_limit = std::max(worst_of_limit, points[p].max_lux_seen / *rig_.points[p].max_lx);
      if (!rig_.points[p].goal_lx) continue;
      const double off = points[p].lux / *rig_.points[p].goal_lx - 1;
      all.add(off);
      if (metered_[p]) metered.add(off);
    }
    const std::vector<double> level = show_.levels();
    for (std::size_t f = 0; f < level.size(); ++f) {
      digest.add(level[f]);
      kwh += level[f] * rig_.luminaires[rig_.fixtures[f].luminaire].watts.value_or(0) *
             (show_.seconds() - recorded_s_) / 3.6e6;
    }
    recorded_s_ = show_.seconds();
  }
  [[nodiscard]] std::vector<double> meters_lx() {
    std::vector<double> lux;
    for (const sim::PointTruth& meter : show_.world().luxmeters()) lux.push_back(meter.lux);
    return lux;
  }

  const Rig& rig_;
  HeldRig show_;
  DaylightOfYear daylight_;
  std::vector<bool> metered_;  ///< per point
  std::vector<double> seen_lx_;
  double looked_s_ = 0, recorded_s_ = 0;
};

}  // namespace

Rig with_blinded_daylight(Rig rig) {
  Daylight daylight;
  daylight.sky = Daylight::SkyKind::overcast;
  daylight.horizontal_lx = kStatedDaylight_lx;
  rig.daylight = daylight;
  return rig;
}

BenchRow simulated_year(const Session& session, const TransportMatrix& light, const BenchOptions& options) {
  BenchRow row;
  row.case_name = "year";
  row.method = session.rig.name + ", real";
  row.error = NAN;
  row.target_seconds = 60;
  const auto seed = static_cast<std::uint64_t>(options.first_seed);
  const int days = options.seconds ? std::max(1, static_cast<int>(*options.seconds / kDay_s))
                   : options.quick ? 7
                                   : kDays;
  auto world = sim::World::make(session.rig, deviations_of_year(seed), kYearTruthError);
  ComputeOptions compute;
  compute.threads = options.threads;
  const auto plan = solve_what_hangs(session, light, compute);
  if (!world || !plan) {
    std::fprintf(stderr, "%s\n", (world ? plan.error() : world.error()).detail.c_str());
    return row;
  }
  const auto started = Clock::now();
  Year year(session, light_model(session.rig, light), std::move(*world), seed);
  year.run(plan->look.levels, days);
  row.seconds = std::chrono::duration<double>(Clock::now() - started).count();
  row.error = year.all.percentile(0.95);
  row.further = {{"cases", fmt::format("{} d", days)},
                 {"corrections", fmt::format("{}", year.show().corrections())},
                 {"goals", year.all.words()},
                 {"at_meters", year.metered.words()},
                 {"of_limit", fmt::format("{:.3f}", year.worst_of_limit)},
                 {"exceeded", fmt::format("{}", year.show().world().violations().size())},
                 {"looks", fmt::format("{}", year.looks)},
                 {"kwh", fmt::format("{:.0f}", year.kwh)},
                 {"digest", fmt::format("{:016x}", year.digest.value())}};
  return row;
}

}  // namespace luxrig
