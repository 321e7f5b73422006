#include "tools/bench/heads/head_meter_run.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr std::size_t kFewestMeters = 3, kMostMeters = 4;
constexpr double kNearestMeter_m = 0.5, kLeastCosine = 0.2;
/// The pan shows only where the beam is not along its axis.
constexpr double kLeastTilt_rad = rad_from_deg(12);
/// A meter sees the beam if it reads this share of what it would at its middle; reflections give less.
constexpr double kSeenShare = 0.1;
/// Aims around a place where the beam was expected, over its radius.
constexpr double kSearchStep = 1.5;
constexpr int kMostSearched = 60;  ///< of all meters together
constexpr int kRing = 8, kMostRounds = 5;
/// The middle of the samples is near enough to the maximum.
constexpr double kCentred = 0.12;
constexpr double kSharpestPeak_rad = rad_from_deg(0.05);
/// Of a log reading, by shape and reflections; and what the width of the beam may be off.
constexpr double kShape = 0.03, kPeakWidth = 0.15;
constexpr double kLeastLux = 0.02;  ///< share of the brightest sample; less tells nothing
constexpr double kSameAim_rad = rad_from_deg(2);
/// For belief: how near the fit has to come to what it was fitted to and to what it was not; and how clearly another
/// kind has to be worse.
constexpr double kPeakExplained_rad = rad_from_deg(0.35), kMeterHit_rad = rad_from_deg(0.3), kPeakErrors = 3,
                 kKindClearly = 12;
/// Standard error per axis over aims all around.
constexpr double kWanted_rad = rad_from_deg(0.25);

/// Four aims from each side tell of both axes.
Approach ring_approach(int number) { return number % 2 == 0 ? Approach{1, 1} : Approach{-1, -1}; }

double pan_share(const Joints& centre) { return std::max(0.1, std::abs(std::sin(centre.tilt_rad))); }

Joints other_posture(const Joints& joints) {
  return {joints.pan_rad + (joints.pan_rad > 0 ? -kPi : kPi), -joints.tilt_rad, joints.beam_rad};
}

Joints within(Joints joints, const JointRange& range) {
  joints.pan_rad = std::clamp(joints.pan_rad, range.pan_min_rad, range.pan_max_rad);
  joints.tilt_rad = std::clamp(joints.tilt_rad, range.tilt_min_rad, range.tilt_max_rad);
  return joints;
}

/// Angles of a beam beside another, across and along its tilt, by its joints.
std::pair<double, double> beside(const Joints& joints, const Joints& centre) {
  const double pan_rad = joints.pan_rad - centre.pan_rad;
  const Vec3 beam(-std::sin(pan_rad) * std::sin(joints.tilt_rad), std::cos(pan_rad) * std::sin(joints.tilt_rad),
                  -std::cos(joints.tilt_rad));
  const double sine = std::sin(centre.tilt_rad), cosine = std::cos(centre.tilt_rad);
  const double across = -std::copysign(1.0, sine) * beam.x(), along = cosine * beam.y() + sine * beam.z();
  const double off = std::hypot(across, along), ahead = sine * beam.y() - cosine * beam.z();
  const double stretch = off > 1e-9 ? std::atan2(off, ahead) / off : 1;
  return {stretch * across, stretch * along};
}

bool near_to(const Joints& a, const Joints& b) {
  return std::abs(a.pan_rad - b.pan_rad) * pan_share(a) < kSameAim_rad &&
         std::abs(a.tilt_rad - b.tilt_rad) < kSameAim_rad;
}

/// Over aims all around: how well the beam's direction is known.
double error_all_around_rad(const HeadFit& fit, const JointRange& range) {
  double squares = 0, count = 0;
  for (double pan_rad = -kPi; pan_rad < kPi - 0.1; pan_rad += kPi / 6)
    for (double tilt_rad = kPi / 9; tilt_rad < kPi / 2; tilt_rad += kPi / 9) {
      const Joints sent = within({pan_rad, tilt_rad, 0}, range);
      const Vec3 beam = fit.pose.beam_world(sent, {});
      const Vec3 place_m = fit.pose.pivot_world_m() + 3 * beam;
      squares += std::pow(aim_error_in_room_rad(fit, {sent, {}, place_m - beam, place_m, -beam, 1}), 2);
      ++count;
    }
  return std::sqrt(squares / count);
}

}  // namespace

BeamFall fall_of(const IntensityDistribution& intensity, double radius_rad) {
  const auto log_at = [&](double share) {
    const double angle_rad = share * radius_rad;
    return std::log(std::max(intensity.intensity_cd(Vec3(std::sin(angle_rad), 0, -std::cos(angle_rad))),
                             1e-6 * intensity.max_intensity_cd()));
  };
  constexpr double kFrom = 0.8, kTo = 1.2;
  const double fall = 2 * (log_at(kFrom) - log_at(kTo)) / ((kTo * kTo - kFrom * kFrom) * radius_rad * radius_rad);
  return {radius_rad, std::max(fall, 0.2 / (radius_rad * radius_rad))};
}

std::optional<LightPeak> light_peak(std::span<const PeakSample> samples, const Joints& centre, const BeamFall& fall,
                                    double noise, double play_rad) {
  using Vector = Eigen::Matrix<double, 6, 1>;
  using Matrix = Eigen::Matrix<double, 6, 6>;
  enum { kLog, kAcross, kAlong, kLogWidth, kPanPlay, kTiltPlay };
  double brightest = 0;
  for (const PeakSample& sample : samples) brightest = std::max(brightest, sample.lux);
  if (!(brightest > 0) || samples.size() < 6) return std::nullopt;
  const double share = pan_share(centre), radius_rad = fall.radius_rad;
  Vector expected = Vector::Zero(), deviation;
  expected[kLog] = std::log(3 * brightest);
  expected[kPanPlay] = play_rad * share;
  expected[kTiltPlay] = play_rad;
  deviation << 3, 2 * radius_rad, 2 * radius_rad, kPeakWidth, play_rad * share, play_rad;
  Vector x = expected;
  Matrix information;
  double squares = 0;
  int used = 0;
  for (int step = 0; step < 25; ++step) {
    information = Vector(deviation.array().square().inverse()).asDiagonal();
    Vector right = information * (expected - x);
    squares = 0;
    used = 0;
    for (const PeakSample& sample : samples) {
      if (sample.lux < kLeastLux * brightest) continue;
      const double k = fall.per_rad2 * std::exp(x[kLogWidth]);
      const auto [u, v] = beside(sample.sent, centre);
      const double across = u - x[kAcross] - sample.from.pan * x[kPanPlay] / 2;
      const double along = v - x[kAlong] - sample.from.tilt * x[kTiltPlay] / 2;
      Vector row;
      row << 1, k * across, k * along, -k / 2 * (across * across + along * along), k * across * sample.from.pan / 2,
          k * along * sample.from.tilt / 2;
      const double off = std::log(sample.lux) - (x[kLog] + row[kLogWidth]);
      const double floor = kShape * brightest / sample.lux * kLeastLux;
      const double variance = noise * noise + kShape * kShape + floor * floor;
      information += row * row.transpose() / variance;
      right += row * off / variance;
      squares += off * off / variance;
      ++used;
    }
    Vector by = information.ldlt().solve(right);
    // A step that leaves the samples would leave where the model holds.
    const double far = by.segment<2>(kAcross).norm() / radius_rad;
    if (far > 0.7) by *= 0.7 / far;
    x += by;
    if (by.segment<2>(kAcross).norm() < 1e-7 && step > 3) break;
  }
  if (used < 6 || !x.allFinite()) return std::nullopt;
  const Matrix covariance = information.ldlt().solve(Matrix::Identity());
  const double scatter = std::max(1.0, squares / std::max(1, used - 4));
  Vector to_side_across = Vector::Zero(), to_side_along = Vector::Zero();
  to_side_across[kAcross] = to_side_along[kAlong] = 1;
  to_side_across[kPanPlay] = to_side_along[kTiltPlay] = 0.5;
  const double variance =
      scatter * 0.5 * (to_side_across.dot(covariance * to_side_across) + to_side_along.dot(covariance * to_side_along));
  LightPeak peak;
  peak.middle = {centre.pan_rad + x[kAcross] / share, centre.tilt_rad + x[kAlong], centre.beam_rad};
  peak.half_play = {std::max(0.0, x[kPanPlay] / 2 / share), std::max(0.0, x[kTiltPlay] / 2), 0};
  peak.standard_error_rad = std::hypot(kSharpestPeak_rad, std::sqrt(variance));
  peak.off_rad = x.segment<2>(kAcross).norm();
  peak.used = used;
  return peak;
}

HeadMeterRun::HeadMeterRun(std::span<const HeadMeter> meters, const IntensityDistribution& intensity,
                           const RayScene& rays, const HeadSetup& setup)
    : meters_(meters.begin(), meters.end()),
      setup_(setup),
      fall_(fall_of(intensity, setup.beam_radius_rad)),
      aims_within_(with_run_up(setup.range)) {
  choose_meters(intensity, rays);
  found_of_usable_.resize(usable_.size());
  if (usable_.size() < kFewestMeters) {
    result_.refused =
        fmt::format("{} luxmeters are where it can light them; {} are needed", usable_.size(), kFewestMeters);
    return;
  }
  choose_targets();
  for (const HeadKind& kind : head_kinds()) fits_.push_back(fit_head(setup.stated, kind, {}, setup.priors));
  at_ = within({}, setup.range);
  steps_ = {Step{at_, false, true}};
}

const HeadMeter& HeadMeterRun::meter_of(const Target& target) const { return meters_[usable_[target.usable].meter]; }

/// Those that the lamp lights; of many, those that lie farthest apart as it sees them.
void HeadMeterRun::choose_meters(const IntensityDistribution& intensity, const RayScene& rays) {
  const Vec3 pivot_m = setup_.stated.translation_m;
  std::vector<Usable> lit;
  std::vector<Vec3> direction;
  for (std::size_t m = 0; m < meters_.size(); ++m) {
    const Vec3 to_m = meters_[m].position_world_m - pivot_m;
    const double distance_m = to_m.norm(), cosine = -to_m.dot(meters_[m].normal_world) / distance_m;
    if (distance_m < kNearestMeter_m || cosine < kLeastCosine) continue;
    if (rays.occluded(meters_[m].position_world_m, meters_[m].normal_world, pivot_m)) continue;
    const auto aim = pan_tilt_towards(setup_.stated, to_m, aims_within_, {});
    if (!aim || std::abs(std::sin(aim->tilt_rad)) < std::sin(kLeastTilt_rad)) continue;
    lit.push_back({m, intensity.max_intensity_cd() * cosine / (distance_m * distance_m)});
    direction.push_back(to_m / distance_m);
  }
  std::vector<std::size_t> chosen;
  while (chosen.size() < std::min(kMostMeters, lit.size())) {
    std::size_t best = lit.size();
    double most = -1;
    for (std::size_t k = 0; k < lit.size(); ++k) {
      if (std::find(chosen.begin(), chosen.end(), k) != chosen.end()) continue;
      double apart = 4;
      for (const std::size_t c : chosen) apart = std::min(apart, (direction[k] - direction[c]).norm());
      if (chosen.empty()) apart = lit[k].peak_lx;  // the brightest first: it is found most easily
      if (apart > most) {
        most = apart;
        best = k;
      }
    }
    chosen.push_back(best);
  }
  for (const std::size_t c : chosen) usable_.push_back(lit[c]);
}

/// All meters in one posture, then in the other. Of four, the last is for the test; of three, it is in the other posture.
void HeadMeterRun::choose_targets() {
  const bool spare = usable_.size() > kFewestMeters;
  for (const bool flipped : {false, true})
    for (std::size_t u = 0; u < usable_.size(); ++u) {
      const bool last = u + 1 == usable_.size();
      if (spare && last && flipped) continue;
      targets_.push_back({u, flipped, last && (spare || flipped)});
    }
  // What is held out comes last.
  std::stable_sort(targets_.begin(), targets_.end(),
                   [](const Target& a, const Target& b) { return a.held_out < b.held_out; });
}

const HeadResult& HeadMeterRun::result() const {
  LUXRIG_CHECK(steps_.empty(), "the run has not ended");
  return result_;
}

std::optional<Joints> HeadMeterRun::towards(const HeadFit& fit, const Target& target) const {
  const Vec3 to_m = meter_of(target).position_world_m - fit.pose.pivot_world_m();
  const std::optional<Joints>& other = found_of_usable_[target.usable];
  const Joints near = target.flipped ? other_posture(other.value_or(at_)) : at_;
  return fit.pose.joints_towards(to_m, {0, 0}, aims_within_, near);
}

void HeadMeterRun::begin_target() {
  for (; target_ < targets_.size(); ++target_) {
    const Target& target = targets_[target_];
    // The other posture only of a meter that was found, and where the head reaches it.
    if (target.flipped && !found_of_usable_[target.usable]) continue;
    part_ = Part::search;
    samples_.clear();
    rounds_ = 0;
    search_aims_of_target();
    if (search_.empty()) continue;
    return search_on();
  }
  end();
}

/// By each kind that is left, the likeliest first; then around those aims.
void HeadMeterRun::search_aims_of_target() {
  const Target& target = targets_[target_];
  std::vector<Joints> centres;
  for (const HeadFit& fit : fits_) {
    const auto joints = towards(fit, target);
    if (!joints) continue;
    if (target.flipped && near_to(*joints, *found_of_usable_[target.usable])) continue;
    if (std::none_of(centres.begin(), centres.end(), [&](const Joints& c) { return near_to(c, *joints); }))
      centres.push_back(*joints);
  }
  std::vector<Aim> aims;
  for (const Joints& centre : centres) aims.push_back({centre, {}});
  for (const double ring : {1.0, 2.0})
    for (const Joints& centre : centres)
      for (int k = 0; k < 6; ++k) {
        const double angle_rad = kPi / 3 * (k + 0.5 * (ring - 1)),
                     far_rad = ring * kSearchStep * setup_.beam_radius_rad;
        aims.push_back({within({centre.pan_rad + far_rad * std::cos(angle_rad) / pan_share(centre),
                                centre.tilt_rad + far_rad * std::sin(angle_rad), 0},
                               aims_within_),
                        {}});
      }
  search_.assign(aims.rbegin(), aims.rend());
}

void HeadMeterRun::search_on() {
  steps_.clear();
  ring_ = {search_.back()};
  search_.pop_back();
  add_steps(ring_.front());
}

void HeadMeterRun::ring_around(Joints centre) {
  part_ = Part::climb;
  centre_ = centre;
  ring_.clear();
  steps_.clear();
  for (int k = 0; k < kRing; ++k) {
    const double angle_rad = 2 * kPi * k / kRing;
    ring_.push_back({within({centre.pan_rad + setup_.beam_radius_rad * std::cos(angle_rad) / pan_share(centre),
                             centre.tilt_rad + setup_.beam_radius_rad * std::sin(angle_rad), 0},
                            aims_within_),
                     ring_approach(k)});
    add_steps(ring_.back());
  }
}

/// Through all play to the aim.
void HeadMeterRun::add_steps(const Aim& aim) {
  ++aims_;
  at_ = aim.joints;
  steps_.push_back(
      {{aim.joints.pan_rad - aim.from.pan * kRunUp_rad, aim.joints.tilt_rad - aim.from.tilt * kRunUp_rad, 0},
       part_ == Part::climb,
       false});
  steps_.push_back({aim.joints, true, true});
}

void HeadMeterRun::take(std::span<const std::vector<double>> lux) {
  const auto read = std::count_if(steps_.begin(), steps_.end(), [](const Step& step) { return step.read; });
  LUXRIG_CHECK(read > 0 && lux.size() == static_cast<std::size_t>(read), "{} of {} readings", lux.size(), read);
  for (const std::vector<double>& at : lux)
    LUXRIG_CHECK(at.size() == meters_.size(), "readings of {} luxmeters", at.size());
  if (part_ == Part::dark) {
    dark_lx_ = lux.front();
    return begin_target();
  }
  const Usable& usable = usable_[targets_[target_].usable];
  const auto of_lamp = [&](std::size_t k) { return lux[k][usable.meter] - dark_lx_[usable.meter]; };
  if (part_ == Part::search) {
    if (of_lamp(0) > kSeenShare * usable.peak_lx) return ring_around(ring_.front().joints);
    if (++searched_ >= kMostSearched) return end();
    return search_.empty() ? leave_target() : search_on();
  }
  for (std::size_t k = 0; k < ring_.size(); ++k)
    if (of_lamp(k) > 0) samples_.push_back({ring_[k].joints, ring_[k].from, of_lamp(k)});
  end_of_ring();
}

void HeadMeterRun::end_of_ring() {
  const Target& target = targets_[target_];
  const auto peak = light_peak(samples_, centre_, fall_, meter_of(target).noise, setup_.priors.play_rad);
  if (!peak) return ++rounds_ >= kMostRounds || samples_.empty() ? leave_target() : ring_around(brightest_middle());
  if (peak->used < kRing || peak->off_rad > kCentred * setup_.beam_radius_rad) {
    if (++rounds_ >= kMostRounds) return leave_target();
    // Off the middle, the lamp's shape matters, so what an earlier ring told is forgotten.
    samples_.clear();
    return ring_around(within(peak->middle, aims_within_));
  }
  const HeadMeter& meter = meter_of(target);
  for (const int side : {1, -1}) {
    const Joints sent{peak->middle.pan_rad + side * peak->half_play.pan_rad,
                      peak->middle.tilt_rad + side * peak->half_play.tilt_rad, 0};
    (target.held_out ? held_out_ : fitted_)
        .push_back({sent,
                    {side, side},
                    meter.position_world_m + meter.normal_world,
                    meter.position_world_m,
                    meter.normal_world,
                    peak->standard_error_rad});
  }
  if (!target.flipped) found_of_usable_[target.usable] = peak->middle;
  if (!target.held_out) {
    fitted_meters_.push_back(target.usable);
    refit();
  }
  leave_target();
}

/// Of the samples, weighed by their light.
Joints HeadMeterRun::brightest_middle() {
  double sum = 0;
  Joints middle;
  for (const PeakSample& sample : samples_) {
    middle.pan_rad += sample.lux * sample.sent.pan_rad;
    middle.tilt_rad += sample.lux * sample.sent.tilt_rad;
    sum += sample.lux;
  }
  samples_.clear();
  return within({middle.pan_rad / sum, middle.tilt_rad / sum, 0}, aims_within_);
}

void HeadMeterRun::leave_target() {
  ++target_;
  begin_target();
}

void HeadMeterRun::refit() {
  for (HeadFit& fit : fits_) fit = fit_head(setup_.stated, fit.kind, fitted_, setup_.priors, &fit);
  std::stable_sort(fits_.begin(), fits_.end(), [](const HeadFit& a, const HeadFit& b) { return a.cost < b.cost; });
}

void HeadMeterRun::end() {
  steps_.clear();
  std::vector<std::size_t> seen = fitted_meters_;
  std::sort(seen.begin(), seen.end());
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  result_.fit = fits_.front();
  result_.fitted = fitted_;
  result_.held_out = held_out_;
  result_.apart = fits_[1].cost - fits_[0].cost;
  if (seen.size() < kFewestMeters) {
    result_.refused = fmt::format("its beam was found at {} luxmeters; {} are needed", seen.size(), kFewestMeters);
    return;
  }
  double worst_rad = 0;
  for (const HeadSighting& sighting : fitted_) {
    const double off_rad = off_sight(result_.fit, sighting).norm();
    if (off_rad > std::max(kPeakErrors * sighting.standard_error_rad, kPeakExplained_rad))
      worst_rad = std::max(worst_rad, off_rad);
  }
  if (worst_rad > 0) {
    result_.refused =
        fmt::format("no pose explains all that was read: one maximum is {:.2f}° off", deg_from_rad(worst_rad));
    return;
  }
  if (*result_.apart < kKindClearly) {
    result_.refused =
        fmt::format("two ways of hanging or turning explain what was read: {:.1f} apart; {:.0f} are needed",
                    *result_.apart, kKindClearly);
    return;
  }
  if (held_out_.empty()) {
    result_.refused = "no luxmeter was left to test it by; one more is needed where its beam reaches it";
    return;
  }
  for (const HeadSighting& sighting : held_out_) {
    const double off_rad = off_sight(result_.fit, sighting).norm();
    const double error_rad = std::hypot(sighting.standard_error_rad, aim_error_rad(result_.fit, sighting));
    if (off_rad < std::max(kMeterHit_rad, kPeakErrors * error_rad) && off_rad < 2 * kMeterHit_rad) continue;
    result_.refused = fmt::format("the luxmeter kept for the test was missed by {:.2f}°", deg_from_rad(off_rad));
    return;
  }
  result_.believed = true;
  std::vector<HeadSighting> all = fitted_;
  all.insert(all.end(), held_out_.begin(), held_out_.end());
  result_.fit = fit_head(setup_.stated, result_.fit.kind, all, setup_.priors, &result_.fit);
  const double error_rad = error_all_around_rad(result_.fit, aims_within_);
  if (error_rad > kWanted_rad)
    result_.refused = fmt::format("its beam is known to {:.2f}° only; {:.2f}° are needed", deg_from_rad(error_rad),
                                  deg_from_rad(kWanted_rad));
}

}  // namespace luxrig
