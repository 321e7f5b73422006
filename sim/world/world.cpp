#include "sim/world/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/check.h"
#include "sim/devices/dimmer.h"
#include "sim/devices/head.h"
#include "sim/devices/luxmeter.h"
#include "sim/world/random.h"

namespace luxrig::sim {
namespace {

constexpr std::size_t kMaxViolations = 1000;
constexpr int kTicksPerSample = 20;  // 5 readings a second
constexpr std::uint64_t kTicksPerSecond = 100;

class MatrixWorld final : public World {
 public:
  MatrixWorld(const Rig& rig, const Deviations& deviations, const Eigen::MatrixXd& lux_per_level,
              std::unique_ptr<const HeadLight> heads, Eigen::VectorXd fixed_lx, MeterResponse response,
              std::vector<FixtureTruth> fixtures)
      : points_(rig.points.size()),
        truths_(fixtures.empty() ? draw_fixtures(rig, deviations) : std::move(fixtures)),
        lux_per_level_(lux_per_level),
        head_light_(std::move(heads)),
        fixed_lx_(std::move(fixed_lx)),
        response_(std::move(response)),
        seed_(deviations.seed),
        cloud_share_(deviations.cloud_share),
        visits_per_minute_(deviations.visits_per_hour / 60),
        level_(Eigen::VectorXd::Zero(lux_per_level.cols())),
        lux_(fixed_lx_),
        peak_lx_(lux_),
        lamp_share_(Eigen::VectorXd::Ones(lux_.size())),
        visited_(Eigen::VectorXd::Ones(lux_.size())),
        cover_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rig.luxmeters.size()))),
        shown_(rig.luxmeters.size()) {
    at_end_of_.resize(rig.fixtures.size());
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
      const FixtureTruth& truth = truths_[f];
      at_end_of_[truth.line] = f;
      dimmers_.emplace_back(DimmerTruth{rig.fixtures[f].dimmer_curve, truth.curve_exponent, truth.of_drive,
                                        truth.dead_band, truth.tail, deviations.lamp_lag_s, truth.warm_up_share,
                                        truth.ageing_per_hour});
      heads_.emplace_back(rig.fixtures[f], truth.head);
      if (head_light_ && rig.fixtures[f].moves) {
        moving_.push_back(f);
        turn_light(f);
      }
    }
    for (std::size_t m = 0; m < rig.luxmeters.size(); ++m) {
      const Luxmeter& meter = rig.luxmeters[m];
      MeterTruth truth;
      truth.gain =
          1 + deviations.meter_gain_share * meter.tolerance * random_signed(deviations.seed, Draw::meter_gain, m, 0);
      truth.noise = deviations.meter_noise;
      truth.lag_s = deviations.meter_lag_s;
      truth.drift_per_hour = deviations.meter_drift_per_hour * random_signed(deviations.seed, Draw::meter_drift, m, 0);
      truth.latency_ticks = static_cast<int>(std::lround(
          (deviations.meter_latency_min_s + (deviations.meter_latency_max_s - deviations.meter_latency_min_s) *
                                                random_unit(deviations.seed, Draw::meter_latency, m, 0)) /
          to_seconds(kTick)));
      truth.range_lx = meter.range_lx;
      truth.lux_per_count = meter.patch.lux_per_count;
      truth.ticks_per_sample = kTicksPerSample;
      truth.first_tick = static_cast<int>(3 * m % kTicksPerSample);
      truth.seed = deviations.seed;
      truth.index = m;
      meters_.emplace_back(truth);
      meter_gains_.push_back(truth.gain);
      meter_points_.push_back(meter.point);
    }
    for (const Point& point : rig.points) limits_lx_.push_back(point.max_lx);
    open_violation_.assign(points_, false);
    light_meters();
    watch_limits();  // daylight may already exceed one
  }

  void set_drive(std::size_t fixture, double drive) override {
    LUXRIG_CHECK(fixture < dimmers_.size(), "fixture {} of {}", fixture, dimmers_.size());
    dimmers_[at_end_of_[fixture]].set_drive(drive);
  }

  void set_lamp_out(std::size_t fixture, bool out) override {
    LUXRIG_CHECK(fixture < dimmers_.size(), "fixture {} of {}", fixture, dimmers_.size());
    dimmers_[fixture].set_out(out);
  }

  void set_aim_target(std::size_t fixture, const Joints& joints) override {
    LUXRIG_CHECK(fixture < heads_.size(), "fixture {} of {}", fixture, heads_.size());
    heads_[at_end_of_[fixture]].set_target(joints);
  }

  void set_joints(std::size_t fixture, const Joints& joints) override {
    LUXRIG_CHECK(fixture < heads_.size(), "fixture {} of {}", fixture, heads_.size());
    heads_[fixture].carry_to(joints);
  }

  void set_shade(std::size_t point, double share) override {
    LUXRIG_CHECK(point < points_, "point {} of {}", point, points_);
    lamp_share_[static_cast<Eigen::Index>(point)] = share;
    for (std::size_t m = 0; m < meter_points_.size(); ++m)
      if (meter_points_[m] == point) lamp_share_[static_cast<Eigen::Index>(points_ + m)] = share;
    changed_ = true;
  }

  void set_cover(std::size_t luxmeter, double share) override {
    LUXRIG_CHECK(luxmeter < meters_.size(), "luxmeter {} of {}", luxmeter, meters_.size());
    cover_[static_cast<Eigen::Index>(luxmeter)] = share;
  }
  void set_shown(std::size_t luxmeter, std::optional<double> lux) override {
    LUXRIG_CHECK(luxmeter < meters_.size(), "luxmeter {} of {}", luxmeter, meters_.size());
    shown_[luxmeter] = lux;
  }

  void set_daylight(double factor) override {
    daylight_ = factor;
    changed_ = true;
  }

  void advance(Time now) override {
    while (this->now() + kTick <= now) tick();
  }

  void stride(Time now) override {
    if (now <= this->now()) return;
    const auto ticks = static_cast<std::uint64_t>((now - this->now()) / kTick);
    if (ticks == 0) return;
    tick_ += ticks;
    pass(static_cast<double>(ticks) * to_seconds(kTick));
    for (std::size_t m = 0; m < meters_.size(); ++m) {
      const auto i = static_cast<Eigen::Index>(m);
      meters_[m].rest(cover_[i] * metered_lx_[i], to_seconds(kTick), tick_);
    }
  }

  [[nodiscard]] Time now() const override { return time_of(tick_); }
  [[nodiscard]] double meter_reading_lx(std::size_t luxmeter) const override {
    LUXRIG_CHECK(luxmeter < meters_.size(), "luxmeter {} of {}", luxmeter, meters_.size());
    return shown_[luxmeter].value_or(meters_[luxmeter].reading_lx());
  }
  [[nodiscard]] Time meter_sampled_at(std::size_t luxmeter) const override {
    LUXRIG_CHECK(luxmeter < meters_.size(), "luxmeter {} of {}", luxmeter, meters_.size());
    return time_of(meters_[luxmeter].sampled_at_tick());
  }

  [[nodiscard]] std::vector<PointTruth> points() const override { return truth_of_rows(0, points_); }
  [[nodiscard]] std::vector<PointTruth> luxmeters() const override { return truth_of_rows(points_, meters_.size()); }
  [[nodiscard]] std::vector<double> levels() const override { return {level_.data(), level_.data() + level_.size()}; }
  [[nodiscard]] std::vector<double> drives() const override {
    std::vector<double> drives;
    for (const Dimmer& dimmer : dimmers_) drives.push_back(dimmer.drive());
    return drives;
  }
  [[nodiscard]] std::vector<Joints> joints() const override {
    std::vector<Joints> joints;
    for (const Head& head : heads_) joints.push_back(head.joints());
    return joints;
  }
  [[nodiscard]] const std::vector<FixtureTruth>& fixtures() const override { return truths_; }
  [[nodiscard]] const std::vector<double>& meter_gains() const override { return meter_gains_; }
  [[nodiscard]] const std::vector<Violation>& violations() const override { return violations_; }

  void reset_peaks() override {
    peak_lx_ = lux_;
    violations_.clear();
    open_violation_.assign(points_, false);
    watch_limits();
  }

 private:
  static Time time_of(std::uint64_t tick) { return Time{} + kTick * static_cast<Duration::rep>(tick); }

  void tick() {
    ++tick_;
    const double dt_s = to_seconds(kTick);
    pass(dt_s);
    for (std::size_t m = 0; m < meters_.size(); ++m) {
      const auto i = static_cast<Eigen::Index>(m);
      meters_[m].step(cover_[i] * metered_lx_[i], dt_s, tick_);
    }
  }

  /// All but the meters, to tick_ from so long before.
  void pass(double dt_s) {
    bool changed = std::exchange(changed_, false);
    for (const std::size_t f : moving_) {
      if (!heads_[f].moving()) continue;
      heads_[f].step(dt_s);
      turn_light(f);
      changed = true;
    }
    if (!head_light_) {
      for (Head& head : heads_) head.step(dt_s);
    }
    for (std::size_t f = 0; f < dimmers_.size(); ++f) {
      dimmers_[f].step(dt_s);
      const double level = dimmers_[f].level() * truths_[f].output;
      const auto i = static_cast<Eigen::Index>(f);
      changed = changed || level != level_[i];
      level_[i] = level;
    }
    if ((tick_ % kTicksPerSecond == 0 || dt_s >= 1) && (cloud_share_ > 0 || visits_per_minute_ > 0)) {
      cloud_ = 1 + cloud_share_ * cloud_at(now());
      visited_ = visits_at(now());
      changed = true;
    }
    if (!changed) return;  // a rig at rest only costs its meters
    lux_.noalias() = lux_per_level_ * level_;
    lux_ = lux_.cwiseProduct(lamp_share_).cwiseProduct(visited_) + daylight_ * cloud_ * fixed_lx_;
    peak_lx_ = peak_lx_.cwiseMax(lux_);
    watch_limits();
    light_meters();
  }

  /// What meters make of the light, by the angles from which it comes.
  void light_meters() {
    const auto first = static_cast<Eigen::Index>(points_), count = static_cast<Eigen::Index>(meters_.size());
    if (response_.of_fixtures.size() == 0) {
      metered_lx_ = lux_.tail(count);
      return;
    }
    metered_lx_ = lux_per_level_.bottomRows(count).cwiseProduct(response_.of_fixtures) * level_;
    metered_lx_ = metered_lx_.cwiseProduct(lamp_share_.tail(count)).cwiseProduct(visited_.tail(count)) +
                  daylight_ * cloud_ * fixed_lx_.segment(first, count).cwiseProduct(response_.of_daylight);
  }

  /// Per row: the share of the lamps' light that whoever stands there now leaves.
  [[nodiscard]] Eigen::VectorXd visits_at(Time at) const {
    Eigen::VectorXd share = Eigen::VectorXd::Ones(lux_.size());
    const double minutes = to_seconds(at.time_since_epoch()) / 60;
    for (double minute = std::max(0.0, std::floor(minutes) - 1); minute <= minutes && points_ > 0; ++minute) {
      const auto k = static_cast<std::uint64_t>(minute);
      const auto draw = [&](std::uint64_t what) { return random_unit(seed_, Draw::visit, what, k); };
      const double begin = minute + draw(1), end = begin + 0.2 + 0.8 * draw(2);
      if (!(draw(0) < visits_per_minute_) || minutes < begin || minutes >= end) continue;
      const std::size_t point = random_bits(seed_, Draw::visit, 3, k) % points_;
      const double left = 0.2 + 0.7 * draw(4);
      share[static_cast<Eigen::Index>(point)] *= left;
      for (std::size_t m = 0; m < meter_points_.size(); ++m)
        if (meter_points_[m] == point) share[static_cast<Eigen::Index>(points_ + m)] *= left;
    }
    return share;
  }

  /// −1…1, smooth: clouds of three minutes, and smaller ones.
  [[nodiscard]] double cloud_at(Time at) const {
    double sum = 0;
    for (const auto& [period_s, share] : {std::pair{180.0, 0.7}, std::pair{40.0, 0.3}}) {
      const double x = to_seconds(at.time_since_epoch()) / period_s, from = std::floor(x), u = x - from;
      const auto k = static_cast<std::uint64_t>(from);
      const auto device = static_cast<std::uint64_t>(period_s);
      const double a = random_signed(seed_, Draw::cloud, device, k),
                   b = random_signed(seed_, Draw::cloud, device, k + 1);
      sum += share * (a + (b - a) * u * u * (3 - 2 * u));
    }
    return sum;
  }

  void turn_light(std::size_t fixture) {
    head_light_->column(fixture, heads_[fixture].joints(), lux_per_level_.col(static_cast<Eigen::Index>(fixture)));
  }

  void watch_limits() {
    for (std::size_t p = 0; p < points_; ++p) {
      if (!limits_lx_[p]) continue;
      const double lux = lux_[static_cast<Eigen::Index>(p)];
      if (lux <= *limits_lx_[p] * (1 + 1e-9)) {  // a limit met exactly, up to rounding, is kept
        open_violation_[p] = false;
        continue;
      }
      if (open_violation_[p]) {
        const auto latest = std::find_if(violations_.rbegin(), violations_.rend(),
                                         [p](const Violation& violation) { return violation.point == p; });
        if (latest != violations_.rend()) latest->lux = std::max(latest->lux, lux);
      } else if (violations_.size() < kMaxViolations) {
        violations_.push_back({p, *limits_lx_[p], lux, now()});
        open_violation_[p] = true;
      }
    }
  }

  [[nodiscard]] std::vector<PointTruth> truth_of_rows(std::size_t first, std::size_t count) const {
    std::vector<PointTruth> truth;
    for (std::size_t i = first; i < first + count; ++i) {
      truth.push_back({lux_[static_cast<Eigen::Index>(i)], peak_lx_[static_cast<Eigen::Index>(i)]});
    }
    return truth;
  }

  std::size_t points_;
  std::vector<FixtureTruth> truths_;
  std::vector<std::size_t> at_end_of_;  ///< per line: the fixture that it reaches
  Eigen::MatrixXd lux_per_level_;
  std::unique_ptr<const HeadLight> head_light_;
  std::vector<std::size_t> moving_;
  std::vector<Dimmer> dimmers_;
  std::vector<Head> heads_;
  std::vector<LuxmeterDevice> meters_;
  std::vector<double> meter_gains_;
  std::vector<std::optional<double>> limits_lx_;
  Eigen::VectorXd fixed_lx_;
  MeterResponse response_;
  std::uint64_t seed_;
  double cloud_share_, visits_per_minute_, cloud_ = 1;
  Eigen::VectorXd level_, lux_, peak_lx_, metered_lx_;
  Eigen::VectorXd lamp_share_, visited_, cover_;  ///< per row; per row, by chance; per luxmeter
  std::vector<std::optional<double>> shown_;  ///< per luxmeter: in place of its light
  double daylight_ = 1;
  bool changed_ = false;  ///< light, by something else than lamps and heads
  std::vector<std::optional<std::size_t>> meter_points_;
  std::vector<Violation> violations_;
  std::vector<bool> open_violation_;
  std::uint64_t tick_ = 0;
};

}  // namespace

Result<std::unique_ptr<World>> World::make(const Rig& rig, const Deviations& deviations,
                                           const Eigen::MatrixXd& lux_per_level, std::unique_ptr<const HeadLight> heads,
                                           const Eigen::VectorXd& fixed_lx, const MeterResponse& response,
                                           std::vector<FixtureTruth> fixtures) {
  const auto rows = static_cast<Eigen::Index>(rig.points.size() + rig.luxmeters.size());
  const auto columns = static_cast<Eigen::Index>(rig.fixtures.size());
  if (lux_per_level.rows() != rows || lux_per_level.cols() != columns) {
    return tl::unexpected(Fault{Cause::invalid,
                                "",
                                fmt::format("transport has {} × {} entries, the rig needs {} × {}",
                                            lux_per_level.rows(), lux_per_level.cols(), rows, columns),
                                {}});
  }
  if (lux_per_level.size() > 0 && !(lux_per_level.allFinite() && lux_per_level.minCoeff() >= 0)) {
    return tl::unexpected(Fault{Cause::invalid, "", "transport has an entry that is negative or not finite", {}});
  }
  Eigen::VectorXd fixed = fixed_lx.size() == 0 ? Eigen::VectorXd::Zero(rows) : fixed_lx;
  if (fixed.size() != rows || (rows > 0 && !(fixed.allFinite() && fixed.minCoeff() >= 0))) {
    return tl::unexpected(
        Fault{Cause::invalid, "", "the fixed light has another size, or an entry that is negative or not finite", {}});
  }
  return std::make_unique<MatrixWorld>(rig, deviations, lux_per_level, std::move(heads), std::move(fixed), response,
                                       std::move(fixtures));
}

}  // namespace luxrig::sim
