#include "core/calibration/head_meter_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

constexpr std::size_t kFewestMeters = 3, kMostMeters = 6;
/// So many targets are searched and read one after the other; the others follow together.
constexpr std::size_t kOneByOne = 3;
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
constexpr double kCentred = 0.2;
constexpr double kSameAim_rad = rad_from_deg(2);
constexpr int kLastFits = 2;
/// For belief: how near the fit has to come to what it was fitted to and to what it was not; and how clearly another
/// kind has to be worse.
constexpr double kPeakExplained_rad = rad_from_deg(0.35), kMeterHit_rad = rad_from_deg(0.3), kPeakErrors = 3,
                 kKindClearly = 12;
/// Standard error per axis over aims all around.
constexpr double kWanted_rad = rad_from_deg(0.25);

/// Four aims from each side tell of both axes.
Approach ring_approach(int number) { return number % 2 == 0 ? Approach{1, 1} : Approach{-1, -1}; }

Joints other_posture(const Joints& joints) {
  return {joints.pan_rad + (joints.pan_rad > 0 ? -kPi : kPi), -joints.tilt_rad, joints.beam_rad};
}

Joints within(Joints joints, const JointRange& range) {
  joints.pan_rad = std::clamp(joints.pan_rad, range.pan_min_rad, range.pan_max_rad);
  joints.tilt_rad = std::clamp(joints.tilt_rad, range.tilt_min_rad, range.tilt_max_rad);
  return joints;
}

bool near_to(const Joints& a, const Joints& b) {
  return std::abs(a.pan_rad - b.pan_rad) * pan_share(a) < kSameAim_rad &&
         std::abs(a.tilt_rad - b.tilt_rad) < kSameAim_rad;
}

/// Of the samples, weighed by their light.
Joints brightest_middle(std::span<const PeakSample> samples) {
  double sum = 0;
  Joints middle;
  for (const PeakSample& sample : samples) {
    middle.pan_rad += sample.lux * sample.sent.pan_rad;
    middle.tilt_rad += sample.lux * sample.sent.tilt_rad;
    sum += sample.lux;
  }
  return {middle.pan_rad / sum, middle.tilt_rad / sum, 0};
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

HeadMeterRun::HeadMeterRun(std::span<const HeadMeter> meters, const IntensityDistribution& intensity,
                           const RayScene& rays, const HeadSetup& setup)
    : meters_(meters.begin(), meters.end()),
      intensity_(intensity),
      rays_(rays),
      setup_(setup),
      fall_(fall_of(intensity, setup.beam_radius_rad)),
      aims_within_(with_run_up(setup.range)) {
  choose_meters();
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

/// Those that the lamp lights; of many, those that lie farthest apart as it sees them.
void HeadMeterRun::choose_meters() {
  const Vec3 pivot_m = setup_.stated.translation_m;
  std::vector<Usable> lit;
  std::vector<Vec3> direction;
  for (std::size_t m = 0; m < meters_.size(); ++m) {
    const Vec3 to_m = meters_[m].position_world_m - pivot_m;
    const double distance_m = to_m.norm(), cosine = -to_m.dot(meters_[m].normal_world) / distance_m;
    if (distance_m < kNearestMeter_m || cosine < kLeastCosine) continue;
    if (rays_.occluded(meters_[m].position_world_m, meters_[m].normal_world, pivot_m)) continue;
    const auto aim = pan_tilt_towards(setup_.stated, to_m, aims_within_, {});
    if (!aim || std::abs(std::sin(aim->tilt_rad)) < std::sin(kLeastTilt_rad)) continue;
    lit.push_back({m, intensity_.max_intensity_cd() * cosine / (distance_m * distance_m)});
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

/// All meters in one posture, then in the other. The last meter is for the test; of three, only in the other posture.
void HeadMeterRun::choose_targets() {
  const bool spare = usable_.size() > kFewestMeters;
  for (const bool flipped : {false, true})
    for (std::size_t u = 0; u < usable_.size(); ++u)
      targets_.push_back({u, flipped, u + 1 == usable_.size() && (spare || flipped)});
}

const HeadResult& HeadMeterRun::result() const {
  LUXRIG_CHECK(steps_.empty(), "the run has not ended");
  return result_;
}

/// The other posture lies near the flipped aim of the first, if that was found.
std::optional<Joints> HeadMeterRun::towards(const HeadFit& fit, const Target& target) const {
  const Vec3 to_m = meter_of(target).position_world_m - fit.pose.pivot_world_m();
  const Target& first = targets_[target.usable];
  std::optional<Joints> one = first.peak ? std::optional(first.peak->middle) : std::nullopt;
  if (!one) one = fit.pose.joints_towards(to_m, {0, 0}, aims_within_, at_);
  if (!target.flipped || !one) return fit.pose.joints_towards(to_m, {0, 0}, aims_within_, one.value_or(at_));
  const auto other = fit.pose.joints_towards(to_m, {0, 0}, aims_within_, other_posture(*one));
  return other && near_to(*other, *one) ? std::nullopt : other;  // the head does not reach it
}

/// The next meters that were not tried.
void HeadMeterRun::go_on() {
  steps_.clear();
  read_.clear();
  const auto found = static_cast<std::size_t>(
      std::count_if(targets_.begin(), targets_.end(), [](const Target& target) { return target.peak.has_value(); }));
  for (std::size_t t = 0; found < kOneByOne && t < targets_.size(); ++t) {
    Target& target = targets_[t];
    if (target.tried || target.flipped || target.held_out) continue;
    target.tried = true;
    part_ = Part::search;
    const std::vector<Joints> aims = search_aims_of(target);
    search_.assign(aims.rbegin(), aims.rend());
    read_ = {{{}, {}, t}};
    if (!search_.empty()) return search_on();
  }
  part_ = Part::rings;
  for (std::size_t t = 0; found >= kOneByOne && t < targets_.size(); ++t) {
    if (std::exchange(targets_[t].tried, true)) continue;
    if (const auto centre = towards(fits_.front(), targets_[t])) add_ring(t, *centre);
  }
  if (steps_.empty()) end();
}

/// By each kind that is left, the likeliest first; then around those aims.
std::vector<Joints> HeadMeterRun::search_aims_of(const Target& target) const {
  std::vector<Joints> aims;
  const auto add = [&](const Joints& aim) {
    if (may_aim(setup_, aim, {})) aims.push_back(aim);
  };
  std::vector<Joints> centres;
  for (const HeadFit& fit : fits_) {
    const auto joints = towards(fit, target);
    if (joints && std::none_of(centres.begin(), centres.end(), [&](const Joints& c) { return near_to(c, *joints); }))
      centres.push_back(*joints);
  }
  for (const Joints& centre : centres) add(centre);
  for (const double ring : {1.0, 2.0})
    for (const Joints& centre : centres)
      for (int k = 0; k < 6; ++k) {
        const double angle_rad = kPi / 3 * (k + 0.5 * (ring - 1)),
                     far_rad = ring * kSearchStep * setup_.beam_radius_rad;
        add(within({centre.pan_rad + far_rad * std::cos(angle_rad) / pan_share(centre),
                    centre.tilt_rad + far_rad * std::sin(angle_rad), 0},
                   aims_within_));
      }
  return aims;
}

void HeadMeterRun::search_on() {
  const std::size_t target = read_.front().target;
  steps_.clear();
  read_.clear();
  add_aim({search_.back(), {}, target});
  search_.pop_back();
}

void HeadMeterRun::add_ring(std::size_t target, const Joints& centre) {
  Target& at = targets_[target];
  std::vector<Aim> ring;
  for (int k = 0; k < kRing; ++k) {
    const double angle_rad = 2 * kPi * k / kRing;
    ring.push_back({within({centre.pan_rad + setup_.beam_radius_rad * std::cos(angle_rad) / pan_share(centre),
                            centre.tilt_rad + setup_.beam_radius_rad * std::sin(angle_rad), 0},
                           aims_within_),
                    ring_approach(k), target});
    if (!may_aim(setup_, ring.back().joints, ring.back().from)) return;
  }
  at.centre = centre;
  at.samples.clear();  // off the middle, the lamp's shape matters, so what an earlier ring told is forgotten
  ++at.rounds;
  for (const Aim& aim : ring) add_aim(aim);
}

/// Through all play to the aim.
void HeadMeterRun::add_aim(const Aim& aim) {
  ++aims_;
  at_ = aim.joints;
  steps_.push_back({run_up_to(aim.joints, aim.from), part_ == Part::rings, false});
  steps_.push_back({aim.joints, true, true});
  read_.push_back(aim);
}

void HeadMeterRun::take(std::span<const std::vector<double>> lux) {
  const auto read = std::count_if(steps_.begin(), steps_.end(), [](const Step& step) { return step.read; });
  LUXRIG_CHECK(read > 0 && lux.size() == static_cast<std::size_t>(read), "{} of {} readings", lux.size(), read);
  for (const std::vector<double>& at : lux)
    LUXRIG_CHECK(at.size() == meters_.size(), "readings of {} luxmeters", at.size());
  if (part_ == Part::dark) {
    dark_lx_ = lux.front();
    return go_on();
  }
  const auto of_lamp = [&](std::size_t k) {
    const std::size_t meter = usable_[targets_[read_[k].target].usable].meter;
    return lux[k][meter] - dark_lx_[meter];
  };
  if (part_ == Part::search) {
    const Aim aim = read_.front();
    if (of_lamp(0) > kSeenShare * usable_[targets_[aim.target].usable].peak_lx) {
      part_ = Part::rings;
      steps_.clear();
      read_.clear();
      add_ring(aim.target, aim.joints);
      return steps_.empty() ? go_on() : void();
    }
    if (++searched_ >= kMostSearched) return end();
    return search_.empty() ? go_on() : search_on();
  }
  for (std::size_t k = 0; k < read_.size(); ++k)
    if (of_lamp(k) > 0) targets_[read_[k].target].samples.push_back({read_[k].joints, read_[k].from, of_lamp(k), 0});
  end_of_rings();
}

/// Rings that are not around their maximum are read once more, around where it seems to be.
void HeadMeterRun::end_of_rings() {
  std::vector<std::pair<std::size_t, Joints>> again;
  for (std::size_t k = 0; k < read_.size(); k += kRing) {
    const std::size_t t = read_[k].target;
    Target& target = targets_[t];
    const auto peak = peak_of(target);
    if (peak && peak->used >= kRing && peak->off_rad < kCentred * setup_.beam_radius_rad) {
      target.peak = peak;
    } else if (target.rounds < kMostRounds && !target.samples.empty()) {
      again.emplace_back(t, within(peak ? peak->middle : brightest_middle(target.samples), aims_within_));
    }
  }
  refit();
  steps_.clear();
  read_.clear();
  for (const auto& [target, centre] : again) add_ring(target, centre);
  if (steps_.empty()) go_on();
}

/// With what the room throws back, as far as is known how the head hangs.
std::optional<LightPeak> HeadMeterRun::peak_of(Target& target) const {
  std::optional<LightPeak> peak;
  for (Joints middle = target.centre; const int pass : {0, 1}) {
    trace_reflections(target, middle);
    peak = light_peak(target.samples, target.centre, fall_, meter_of(target).noise, setup_.priors.play_rad);
    if (!peak || pass == 1) break;
    middle = peak->middle;
  }
  return peak;
}

/// middle: where the beam points at the meter.
void HeadMeterRun::trace_reflections(Target& target, const Joints& middle) const {
  const HeadPose& pose = fits_.front().pose;
  const Vec3 straight = (meter_of(target).position_world_m - pose.pivot_world_m()).normalized();
  const Mat3 put_right = shortest_rotation(pose.beam_world(middle, {0, 0}), straight);
  for (PeakSample& sample : target.samples) {
    const Vec3 beam = put_right * pose.beam_world(sample.sent, sample.from);
    sample.reflected = reflected_over_peak(rays_, meter_of(target), intensity_,
                                           {shortest_rotation(-Vec3::UnitZ(), beam), pose.pivot_world_m()});
  }
}

std::vector<HeadSighting> HeadMeterRun::sightings(bool held_out) const {
  std::vector<HeadSighting> list;
  for (const Target& target : targets_) {
    if (!target.peak || target.held_out != held_out) continue;
    const HeadMeter& meter = meter_of(target);
    for (const int side : {1, -1})
      list.push_back({{target.peak->middle.pan_rad + side * target.peak->half_play.pan_rad,
                       target.peak->middle.tilt_rad + side * target.peak->half_play.tilt_rad, 0},
                      {side, side},
                      meter.position_world_m + meter.normal_world,
                      meter.position_world_m,
                      meter.normal_world,
                      target.peak->standard_error_rad});
  }
  return list;
}

std::size_t HeadMeterRun::meters_seen(bool held_out) const {
  std::vector<std::size_t> seen;
  for (const Target& target : targets_)
    if (target.peak && target.held_out == held_out) seen.push_back(target.usable);
  std::sort(seen.begin(), seen.end());
  return static_cast<std::size_t>(std::unique(seen.begin(), seen.end()) - seen.begin());
}

void HeadMeterRun::refit() {
  const std::vector<HeadSighting> fitted = sightings(false);
  for (HeadFit& fit : fits_) fit = fit_head(setup_.stated, fit.kind, fitted, setup_.priors, &fit);
  std::stable_sort(fits_.begin(), fits_.end(), [](const HeadFit& a, const HeadFit& b) { return a.cost < b.cost; });
}

void HeadMeterRun::end() {
  steps_.clear();
  for (int k = 0; k < kLastFits; ++k) {
    for (Target& target : targets_)
      if (target.peak) target.peak = peak_of(target);
    refit();
  }
  result_.fit = fits_.front();
  result_.fitted = sightings(false);
  result_.held_out = sightings(true);
  result_.apart = fits_[1].cost - fits_[0].cost;
  result_.refused = why_refused();
  result_.believed = !result_.refused;
  if (!result_.believed) return;
  std::vector<HeadSighting> all = result_.fitted;
  all.insert(all.end(), result_.held_out.begin(), result_.held_out.end());
  result_.fit = fit_head(setup_.stated, result_.fit.kind, all, setup_.priors, &result_.fit);
  const double error_rad = error_all_around_rad(result_.fit, aims_within_);
  if (error_rad > kWanted_rad)
    result_.refused = fmt::format("its beam is known to {:.2f}° only; {:.2f}° are needed", deg_from_rad(error_rad),
                                  deg_from_rad(kWanted_rad));
}

std::optional<std::string> HeadMeterRun::why_refused() const {
  if (const std::size_t seen = meters_seen(false); seen < kFewestMeters)
    return fmt::format("its beam was found at {} luxmeters; {} are needed", seen, kFewestMeters);
  double worst_rad = 0;
  for (const HeadSighting& sighting : result_.fitted) {
    const double off_rad = off_sight(result_.fit, sighting).norm();
    if (off_rad > std::max(kPeakErrors * sighting.standard_error_rad, kPeakExplained_rad))
      worst_rad = std::max(worst_rad, off_rad);
  }
  if (worst_rad > 0)
    return fmt::format("no pose explains all that was read: one maximum is {:.2f}° off", deg_from_rad(worst_rad));
  if (*result_.apart < kKindClearly)
    return fmt::format("two ways of hanging or turning explain what was read: {:.1f} apart; {:.0f} are needed",
                       *result_.apart, kKindClearly);
  if (result_.held_out.empty())
    return "no luxmeter was left to test it by; one more is needed where its beam reaches it";
  for (const HeadSighting& sighting : result_.held_out) {
    const double off_rad = off_sight(result_.fit, sighting).norm();
    const double error_rad = std::hypot(sighting.standard_error_rad, aim_error_rad(result_.fit, sighting));
    if (off_rad < std::max(kMeterHit_rad, kPeakErrors * error_rad) && off_rad < 2 * kMeterHit_rad) continue;
    return fmt::format("the luxmeter kept for the test was missed by {:.2f}°", deg_from_rad(off_rad));
  }
  return std::nullopt;
}

}  // namespace luxrig
