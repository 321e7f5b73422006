#include "core/calibration/head_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

/// Sightings that are fitted, and those kept for the test; and so many more aims at most, as some lose the beam.
constexpr std::size_t kFitted = 18, kHeldOut = 6;
constexpr int kMore = 8;
/// A sighting that is less certain would hardly test a pose.
constexpr double kSharp_rad = rad_from_deg(0.08);
/// Where it was seen, and after a probe of pan or of tilt.
constexpr std::size_t kToBeginWith = 2;
constexpr double kProbes_rad[] = {rad_from_deg(10), -rad_from_deg(10), rad_from_deg(5), -rad_from_deg(5)};
/// A kind is given up when so many sightings speak so much against it.
constexpr std::size_t kSightingsToDrop = 4;
constexpr double kDrop = 40;
/// Standard error of a sighting to come, for the choice of aims.
constexpr double kOnOnePlane_rad = rad_from_deg(0.03), kAcrossEdges_rad = rad_from_deg(0.5);
/// For the test: a place that was used is worth so much of a new one, and one across edges hardly tells anything.
constexpr double kPlaceAgain = 0.3, kAcrossEdgesLast = 1e-4;
/// What an aim takes beside its way: lamp on, pictures.
constexpr double kPerAim_s = 0.6;

/// Each joint from each side, in turns.
Approach approach_of(int number) {
  constexpr Approach kTurns[] = {{1, 1}, {-1, -1}, {1, -1}, {-1, 1}};
  return kTurns[number % 4];
}

double way_s(const HeadSetup& setup, const Joints& a, const Joints& b) {
  return std::max(std::abs(a.pan_rad - b.pan_rad) / setup.pan_speed_rad_s,
                  std::abs(a.tilt_rad - b.tilt_rad) / setup.tilt_speed_rad_s);
}

/// The other posture with about the same beam.
Joints flipped(const Joints& joints) {
  return {joints.pan_rad + (joints.pan_rad > 0 ? -kPi : kPi), -joints.tilt_rad, joints.beam_rad};
}

HeadSighting sighting_to_come(const HeadPlace& place, const Vec3& eye_world_m, const Joints& sent,
                              const Approach& from) {
  return {sent,
          from,
          eye_world_m,
          place.position_world_m,
          place.normal_world,
          place.on_one_plane ? kOnOnePlane_rad : kAcrossEdges_rad};
}

}  // namespace

HeadRun::HeadRun(const SeenSurface& surface, const RayScene& rays, const HeadSetup& setup)
    : surface_(surface),
      setup_(setup),
      aims_within_(with_run_up(setup.range)),
      places_(head_places(surface, rays, setup)),
      search_(search_aims(surface, rays, setup, places_)),
      used_(places_.size(), 0) {
  LUXRIG_CHECK(setup.pan_speed_rad_s > 0 && setup.tilt_speed_rad_s > 0, "a head without speed");
  for (const HeadKind& kind : head_kinds()) fits_.push_back(fit_head(setup.stated, kind, {}, setup.priors));
  aim_.joints = {std::clamp(0.0, setup.range.pan_min_rad, setup.range.pan_max_rad),
                 std::clamp(0.0, setup.range.tilt_min_rad, setup.range.tilt_max_rad), 0};
  go_to(plan());
  if (!aims_) end();
}

const HeadResult& HeadRun::result() const {
  LUXRIG_CHECK(!step_, "the run has not ended");
  return result_;
}

void HeadRun::take(const Picture& picture) {
  LUXRIG_CHECK(step_, "the run has ended");
  if (step_->lit) {
    take_lit(picture);
    return;
  }
  if (waits_for_dark_) confirm(picture);
  dark_ = picture;
  if (last_) {
    end();
    return;
  }
  step_ = HeadStep{aim_.joints, true};
}

void HeadRun::take_lit(const Picture& picture) {
  const bool tests = part_ == Part::test;
  auto spot = beam_spot(surface_, picture, dark_, fits_.front().pose.pivot_world_m());
  if (spot) {
    const double error_rad = centre_of(*spot, fits_.front().pose.pivot_world_m()).standard_error_rad;
    sighted_.push_back({std::move(*spot), aim_, tests, error_rad < kSharp_rad});
    waits_for_dark_ = true;
    if (!tests) refit();
  } else {
    lose(spot.error());
  }
  go_to(plan());
}

void HeadRun::confirm(const Picture& dark) {
  waits_for_dark_ = false;
  if (vanished(sighted_.back().spot, dark_, dark)) return;
  const bool fitted = !sighted_.back().held_out;
  sighted_.pop_back();
  lose(NoBeam::stays);
  if (fitted) refit();
}

void HeadRun::lose(NoBeam why) { ++lost_[static_cast<std::size_t>(why)]; }

/// nullopt: it is the last, and the light goes off once more.
void HeadRun::go_to(const std::optional<Aim>& aim) {
  if (!aim) {
    last_ = true;
    step_ = HeadStep{aim_.joints, false};
    return;
  }
  ++aims_;
  aim_ = *aim;
  tried_.push_back(aim_.joints);
  if (aim_.place) used_[*aim_.place] = 1;
  step_ = HeadStep{run_up_to(aim_.joints, aim_.from), false};
}

std::size_t HeadRun::count(bool held_out) const {
  return static_cast<std::size_t>(
      std::count_if(sighted_.begin(), sighted_.end(), [&](const Sighted& s) { return s.held_out == held_out; }));
}

std::optional<HeadRun::Aim> HeadRun::plan() {
  if (part_ == Part::search && count(false) > first_) {
    part_ = Part::pan_probe;
    probed_ = 0;
  }
  if (part_ == Part::pan_probe) {
    if (const auto aim = probe(true)) return aim;
    part_ = Part::tilt_probe;
    probed_ = 0;
  }
  if (part_ == Part::tilt_probe) {
    if (const auto aim = probe(false)) return aim;
    // What was seen but once may have been a reflection.
    part_ = count(false) >= first_ + kToBeginWith ? Part::spread : Part::search;
    first_ = count(false);
  }
  if (part_ == Part::search)
    return searched_ < search_.size() ? std::optional(Aim{search_[searched_++], {}}) : std::nullopt;
  if (part_ == Part::spread) {
    if (count(false) < kFitted && spread_ < static_cast<int>(kFitted) + kMore) {
      ++spread_;
      if (const auto aim = most_informative()) return aim;
    }
    part_ = Part::test;
  }
  const auto sharp =
      std::count_if(sighted_.begin(), sighted_.end(), [](const Sighted& seen) { return seen.held_out && seen.tells; });
  if (sharp >= static_cast<std::ptrdiff_t>(kHeldOut) || tested_ >= static_cast<int>(kHeldOut) + kMore)
    return std::nullopt;
  ++tested_;
  return farthest_from_tried();
}

/// From where the beam was seen first, until one of the ways shows it again.
std::optional<HeadRun::Aim> HeadRun::probe(bool pan) {
  if (sighted_.size() <= first_) return std::nullopt;  // it was somebody else's light
  const bool seen = probed_ > 0 && sighted_.back().aim.joints == aim_.joints;
  while (!seen && probed_ < static_cast<int>(std::size(kProbes_rad))) {
    Joints joints = sighted_[first_].aim.joints;
    (pan ? joints.pan_rad : joints.tilt_rad) += kProbes_rad[probed_++];
    joints.pan_rad = std::clamp(joints.pan_rad, aims_within_.pan_min_rad, aims_within_.pan_max_rad);
    joints.tilt_rad = std::clamp(joints.tilt_rad, aims_within_.tilt_min_rad, aims_within_.tilt_max_rad);
    if (may_aim(setup_, joints, {})) return Aim{joints, {}};
  }
  return std::nullopt;
}

/// The aim that narrows the beam's error most, over all places and by its time.
std::optional<HeadRun::Aim> HeadRun::most_informative() const {
  const HeadFit& fit = fits_.front();
  const Vec3 eye_m = surface_.camera.eye_world_m, pivot_m = fit.pose.pivot_world_m();
  const Approach from = approach_of(spread_);
  struct Candidate {
    Aim aim;
    FitRows rows;
    double variance;
  };
  std::vector<Candidate> candidates;
  FitMatrix wanted = FitMatrix::Zero();
  for (std::size_t p = 0; p < places_.size(); ++p) {
    std::optional<Joints> last;
    for (const Joints& near : {aim_.joints, flipped(aim_.joints)}) {
      const auto joints = fit.pose.joints_towards(places_[p].position_world_m - pivot_m, from, aims_within_, near);
      if (!joints || (last && same_aim(*last, *joints))) continue;
      last = joints;
      const HeadSighting seen = sighting_to_come(places_[p], eye_m, *joints, from);
      FitRows rows = off_sight_rows(fit, seen);
      if (!used_[p] && may_aim(setup_, *joints, from))
        candidates.push_back({{*joints, from, p}, rows, std::pow(seen.standard_error_rad, 2)});
      rows.rightCols<3>().setZero();
      wanted.noalias() += rows.transpose() * rows;
    }
  }
  const FitMatrix gain_of = fit.covariance * wanted * fit.covariance;
  std::optional<Aim> best;
  double most = 0;
  for (const Candidate& candidate : candidates) {
    const Mat3 spread =
        candidate.rows * fit.covariance * candidate.rows.transpose() + candidate.variance * Mat3::Identity();
    const Mat3 gain = candidate.rows * gain_of * candidate.rows.transpose();
    const double per_s = spread.ldlt().solve(gain).trace() /
                         (kPerAim_s + way_s(setup_, aim_.joints, run_up_to(candidate.aim.joints, from)));
    if (!(per_s > most)) continue;
    most = per_s;
    best = candidate.aim;
  }
  return best;
}

/// For the test: joints far from all that were tried, at a new place if there is one.
std::optional<HeadRun::Aim> HeadRun::farthest_from_tried() const {
  const HeadPose& pose = fits_.front().pose;
  const Approach from = approach_of(tested_);
  std::optional<Aim> best;
  double most = 0;
  for (std::size_t p = 0; p < places_.size(); ++p)
    for (const Joints& near : {aim_.joints, flipped(aim_.joints)}) {
      const Vec3 to_m = places_[p].position_world_m - pose.pivot_world_m();
      const auto joints = pose.joints_towards(to_m, from, aims_within_, near);
      if (!joints || !may_aim(setup_, *joints, from)) continue;
      double apart_rad = kPi;
      for (const Joints& tried : tried_)
        apart_rad = std::min(apart_rad, std::max(std::abs(tried.pan_rad - joints->pan_rad),
                                                 std::abs(tried.tilt_rad - joints->tilt_rad)));
      const double worth = (used_[p] ? kPlaceAgain : 1) * (places_[p].on_one_plane ? 1 : kAcrossEdgesLast) * apart_rad /
                           (kPerAim_s + way_s(setup_, aim_.joints, *joints));
      if (worth <= most) continue;
      most = worth;
      best = Aim{*joints, from, p};
    }
  return best;
}

std::vector<HeadSighting> HeadRun::sightings(bool held_out, const Vec3& pivot_world_m) const {
  std::vector<HeadSighting> list;
  for (const Sighted& seen : sighted_) {
    if (seen.held_out != held_out) continue;
    const SpotCentre centre = centre_of(seen.spot, pivot_world_m);
    list.push_back({seen.aim.joints, seen.aim.from, surface_.camera.eye_world_m, centre.position_world_m,
                    centre.normal_world, centre.standard_error_rad});
  }
  return list;
}

void HeadRun::refit() {
  const std::vector<HeadSighting> seen = sightings(false, fits_.front().pose.pivot_world_m());
  for (HeadFit& fit : fits_) fit = fit_head(setup_.stated, fit.kind, seen, setup_.priors, &fit);
  std::stable_sort(fits_.begin(), fits_.end(), [](const HeadFit& a, const HeadFit& b) { return a.cost < b.cost; });
  if (seen.size() < kSightingsToDrop) return;
  while (fits_.size() > 1 && !(fits_.back().cost < fits_.front().cost + kDrop)) fits_.pop_back();
}

void HeadRun::end() {
  step_.reset();
  if (sighted_.empty()) {
    std::string found;
    for (std::size_t why = 0; why < lost_.size(); ++why)
      if (lost_[why] > 0) found += fmt::format("; {}: {}", words_of(static_cast<NoBeam>(why)), lost_[why]);
    result_.refused = fmt::format("its beam was not seen at {} aims{}", aims_, found);
    return;
  }
  refit();  // from the lamp's place as it is known now
  const Vec3 pivot_m = fits_.front().pose.pivot_world_m();
  result_.fit = fits_.front();
  result_.fitted = sightings(false, pivot_m);
  result_.held_out = sightings(true, pivot_m);
  if (fits_.size() > 1) result_.apart = fits_[1].cost - fits_[0].cost;
  conclude(setup_.priors, result_);
}

}  // namespace luxrig
