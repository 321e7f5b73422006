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

class MatrixWorld final : public World {
 public:
  MatrixWorld(const Rig& rig, const Deviations& deviations, const Eigen::MatrixXd& lux_per_level,
              std::unique_ptr<const HeadLight> heads, Eigen::VectorXd fixed_lx)
      : points_(rig.points.size()),
        truths_(draw_fixtures(rig, deviations)),
        lux_per_level_(lux_per_level),
        head_light_(std::move(heads)),
        fixed_lx_(std::move(fixed_lx)),
        level_(Eigen::VectorXd::Zero(lux_per_level.cols())),
        lux_(fixed_lx_),
        peak_lx_(lux_),
        lamp_share_(Eigen::VectorXd::Ones(lux_.size())),
        cover_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(rig.luxmeters.size()))),
        shown_(rig.luxmeters.size()) {
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
      dimmers_.emplace_back(rig.fixtures[f].dimmer_curve, truths_[f].curve_exponent, deviations.lamp_lag_s);
      heads_.emplace_back(rig.fixtures[f]);
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
    watch_limits();  // daylight may already exceed one
  }

  void set_drive(std::size_t fixture, double drive) override {
    LUXRIG_CHECK(fixture < dimmers_.size(), "fixture {} of {}", fixture, dimmers_.size());
    dimmers_[fixture].set_drive(drive);
  }

  void set_lamp_out(std::size_t fixture, bool out) override {
    LUXRIG_CHECK(fixture < dimmers_.size(), "fixture {} of {}", fixture, dimmers_.size());
    dimmers_[fixture].set_out(out);
  }

  void set_aim_target(std::size_t fixture, const Joints& joints) override {
    LUXRIG_CHECK(fixture < heads_.size(), "fixture {} of {}", fixture, heads_.size());
    heads_[fixture].set_target(joints);
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
    if (changed) {  // a rig at rest only costs its meters
      lux_.noalias() = lux_per_level_ * level_;
      lux_ = lux_.cwiseProduct(lamp_share_) + daylight_ * fixed_lx_;
      peak_lx_ = peak_lx_.cwiseMax(lux_);
      watch_limits();
    }
    for (std::size_t m = 0; m < meters_.size(); ++m) {
      const auto i = static_cast<Eigen::Index>(m);
      meters_[m].step(cover_[i] * lux_[static_cast<Eigen::Index>(points_) + i], dt_s, tick_);
    }
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
  Eigen::MatrixXd lux_per_level_;
  std::unique_ptr<const HeadLight> head_light_;
  std::vector<std::size_t> moving_;
  std::vector<Dimmer> dimmers_;
  std::vector<Head> heads_;
  std::vector<LuxmeterDevice> meters_;
  std::vector<double> meter_gains_;
  std::vector<std::optional<double>> limits_lx_;
  Eigen::VectorXd fixed_lx_, level_, lux_, peak_lx_;
  Eigen::VectorXd lamp_share_, cover_;  ///< per row; per luxmeter
  std::vector<std::optional<double>> shown_;  ///< per luxmeter: in place of its light
  double daylight_ = 1;
  bool changed_ = false;  ///< light, by something else than lamps and heads
  std::vector<std::optional<std::size_t>> meter_points_;
  std::vector<Violation> violations_;
  std::vector<bool> open_violation_;
  std::uint64_t tick_ = 0;
};

}  // namespace

Deviations Deviations::none() {
  Deviations none;
  none.output_min = none.output_max = 1;
  none.curve_exponent_spread = none.position_error_m = none.angle_error_rad = 0;
  none.meter_gain_share = none.meter_noise = none.meter_lag_s = none.lamp_lag_s = 0;
  return none;
}

std::vector<FixtureTruth> draw_fixtures(const Rig& rig, const Deviations& deviations) {
  const std::uint64_t seed = deviations.seed;
  std::vector<FixtureTruth> truths;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    FixtureTruth truth;
    truth.output = deviations.output_min +
                   (deviations.output_max - deviations.output_min) * random_unit(seed, Draw::lamp_output, f, 0);
    truth.curve_exponent = 1 + deviations.curve_exponent_spread * random_signed(seed, Draw::curve_exponent, f, 0);
    Vec3 offset_m, turn_rad;
    for (int axis = 0; axis < 3; ++axis) {
      const auto counter = static_cast<std::uint64_t>(axis);
      offset_m[axis] = deviations.position_error_m * random_normal(seed, Draw::mount_position, f, counter);
      turn_rad[axis] = deviations.angle_error_rad * random_normal(seed, Draw::mount_angle, f, counter);
    }
    const Pose& nominal = rig.fixtures[f].world_from_mount;
    truth.world_from_mount = nominal;
    truth.world_from_mount.translation_m += offset_m;
    if (const double angle_rad = turn_rad.norm(); angle_rad > 0) {
      truth.world_from_mount.rotation =
          Eigen::AngleAxisd(angle_rad, turn_rad / angle_rad).toRotationMatrix() * nominal.rotation;
    }
    truths.push_back(truth);
  }
  return truths;
}

Result<std::unique_ptr<World>> World::make(const Rig& rig, const Deviations& deviations,
                                           const Eigen::MatrixXd& lux_per_level, std::unique_ptr<const HeadLight> heads,
                                           const Eigen::VectorXd& fixed_lx) {
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
  return std::make_unique<MatrixWorld>(rig, deviations, lux_per_level, std::move(heads), std::move(fixed));
}

}  // namespace luxrig::sim
