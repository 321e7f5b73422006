// How a held show names faults that no device reports, what it says when there is none, and how it corrects where each
// lamp also lights its neighbour's meter, beside a PI loop on each meter.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <random>

#include "core/output/dimming.h"
#include "core/parallel.h"
#include "core/rig/rig_file.h"
#include "core/tasks/light.h"
#include "core/tasks/scene_builder.h"
#include "core/tasks/session.h"
#include "tools/bench/hold/held_rig.h"
#include "tools/bench/hold/year.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Clock = std::chrono::steady_clock;

constexpr double kHoldError = 0.005;
constexpr double kSettledAfter_s = 90, kNamedWithin_s = 60;
constexpr double kKnocked_rad = 0.3;

/// Lamps that a meter would miss: they give it a good part of its light.
std::vector<std::size_t> seen_lamps(const std::vector<double>& level, const LightModel& model) {
  std::vector<std::size_t> seen;
  for (std::size_t f = 0; f < level.size(); ++f)
    for (Index m = 0; m < model.meter_lux_per_level.rows(); ++m) {
      const double of_lamp = model.meter_lux_per_level(m, static_cast<Index>(f)) * level[f];
      const double all = model.meter_lux_per_level.row(m).dot(
          Eigen::Map<const VectorXd>(level.data(), static_cast<Index>(level.size())));
      if (of_lamp > 0.15 * all && of_lamp > 5) {
        seen.push_back(f);
        break;
      }
    }
  return seen;
}

class FaultCases {
 public:
  FaultCases(const Session& session, const LightModel& model, std::uint64_t seed)
      : session_(session), model_(model), random_(seed), seed_(seed) {}

  static constexpr const char* kKinds[] = {"dead lamp",      "dim lamp",      "covered meter", "wrong meter",
                                           "swapped meters", "swapped lamps", "knocked lamp"};

  /// none = this rig has nothing that could fail so, or its world could not be made.
  struct Outcome {
    std::optional<double> named_s;  ///< alone
    bool among = false;             ///< with others, or later: something named it
    bool wrong = false;             ///< something else alone was named
    std::string said;
  };
  std::optional<Outcome> run(const std::string& kind) {
    sim::Deviations real = sim::Deviations::real();
    real.seed = seed_;
    real.visits_per_hour = 0;
    auto world = sim::World::make(session_.rig, real, kHoldError);
    if (!world) return std::nullopt;
    HeldRig rig(session_.rig, model_, std::move(*world));
    const std::vector<double> half(session_.rig.fixtures.size(), 0.4);
    rig.apply(half);
    const std::vector<std::size_t> seen = seen_lamps(half, model_);
    if (seen.size() < 2) return std::nullopt;
    // Something that will be knocked is driven along from the start.
    const std::size_t head = seen[random_() % seen.size()];
    if (kind == "knocked lamp") {
      Rig knocked = session_.rig;
      turn_aside(knocked.fixtures[head]);
      auto other = sim::World::make(knocked, real, kHoldError);
      if (!other) return std::nullopt;
      rig.knock(std::move(*other));
    }
    rig.run(kSettledAfter_s);
    const auto said = begin(kind, rig, head);
    if (!said) return std::nullopt;
    return outcome_of(rig, *said);
  }

 private:
  [[nodiscard]] std::string lamp(std::size_t f) const { return "\"" + session_.rig.fixtures[f].name + "\""; }
  [[nodiscard]] std::string meter(std::size_t m) const { return "\"" + session_.rig.luxmeters[m].name + "\""; }

  /// Its beam goes aside, whichever way: a turn about the beam itself would change next to nothing.
  void turn_aside(Fixture& fixture) {
    const Vec3 beam = -fixture.world_from_lamp().rotation.col(2);
    const double way = 2 * kPi * std::uniform_real_distribution<double>()(random_);
    const Vec3 across = beam.unitOrthogonal(), axis = Eigen::AngleAxisd(way, beam) * across;
    Pose& mount = fixture.world_from_mount;
    mount.rotation = Eigen::AngleAxisd(kKnocked_rad, axis).toRotationMatrix() * mount.rotation;
  }

  std::optional<std::vector<std::string>> begin(const std::string& kind, HeldRig& rig, std::size_t head) {
    const std::vector<std::size_t> seen = seen_lamps(rig.levels(), model_);
    const std::size_t meters = session_.rig.luxmeters.size();
    if (seen.size() < 2 || meters < 2) return std::nullopt;
    const std::size_t f = seen[random_() % seen.size()], m = random_() % meters;
    if (kind == "dead lamp") {
      rig.on_the_way = [f](std::vector<LevelCommand>& commands) { commands[f].drive = 0; };
      return {{"lamp " + lamp(f), "no light"}};
    }
    if (kind == "dim lamp") {
      const Fixture& fixture = session_.rig.fixtures[f];
      rig.on_the_way = [f, &fixture](std::vector<LevelCommand>& commands) {
        commands[f].drive = drive_for(fixture, 0.6 * level_at(fixture, commands[f].drive));
      };
      return {{"lamp " + lamp(f), "% of its light"}};
    }
    if (kind == "covered meter" || kind == "wrong meter") {
      const double share = kind == "covered meter" ? 0.3 : 1.4;
      rig.as_read = [m, share](LuxReading& reading) {
        if (reading.luxmeter == m) reading.lux *= share;
      };
      return {{"luxmeter " + meter(m)}};
    }
    if (kind == "swapped meters") {
      const std::size_t other = (m + 1) % meters;
      rig.as_read = [m, other](LuxReading& reading) {
        reading.luxmeter = reading.luxmeter == m ? other : reading.luxmeter == other ? m : reading.luxmeter;
      };
      return {{meter(m), meter(other), "exchanged"}};
    }
    if (kind == "swapped lamps") {
      const std::size_t other =
          seen[(static_cast<std::size_t>(std::find(seen.begin(), seen.end(), f) - seen.begin()) + 1) % seen.size()];
      rig.on_the_way = [f, other](std::vector<LevelCommand>& commands) {
        std::swap(commands[f].drive, commands[other].drive);
      };
      return {{lamp(f), lamp(other), "each other's level"}};
    }
    rig.knocked_now();
    return {{lamp(head), "shines elsewhere"}};
  }

  static Outcome outcome_of(HeldRig& rig, const std::vector<std::string>& said) {
    Outcome outcome;
    const double begun = rig.seconds();
    const auto found = [&]() -> std::optional<std::string> {
      for (const Alarm& alarm : rig.status().alarms)
        if (alarm.text.find("readings: ") != std::string::npos) return alarm.text;
      return std::nullopt;
    };
    while (rig.seconds() < begun + kNamedWithin_s) {
      rig.run(0.5);
      const auto text = found();
      if (!text) continue;
      outcome.said = *text;
      // The readings behind it name all meters that changed.
      const std::string cause = text->substr(0, text->find("; readings: "));
      const bool names = std::all_of(said.begin(), said.end(),
                                     [&](const std::string& part) { return cause.find(part) != std::string::npos; });
      const bool alone = text->find("either ") != 0 && text->find("no single fault") == std::string::npos;
      outcome.among = outcome.among || names;
      if (!alone) continue;
      if (names) {
        outcome.named_s = rig.seconds() - begun;
        return outcome;
      }
      outcome.wrong = true;
    }
    return outcome;
  }

  const Session& session_;
  const LightModel& model_;
  std::mt19937_64 random_;
  std::uint64_t seed_;
};

BenchRow held_row(std::string case_name, std::string method, double error, double target) {
  BenchRow row;
  row.case_name = std::move(case_name);
  row.method = std::move(method);
  row.error = error;
  row.target_error = target;
  return row;
}

std::vector<BenchRow> named_faults(const Session& session, const LightModel& model, const BenchOptions& options) {
  std::vector<BenchRow> rows;
  const int seeds = options.seeds.value_or(options.quick ? 2 : 10);
  for (const char* kind : FaultCases::kKinds) {
    const auto started = Clock::now();
    int cases = 0, named = 0, among = 0, wrong = 0;
    std::vector<double> after_s;
    for (int s = 0; s < seeds; ++s) {
      const auto seed = static_cast<std::uint64_t>(options.first_seed + s);
      const auto outcome = FaultCases(session, model, seed).run(kind);
      if (!outcome) continue;
      ++cases;
      named += outcome->named_s.has_value();
      among += !outcome->named_s && outcome->among;
      wrong += outcome->wrong;
      if (outcome->named_s) after_s.push_back(*outcome->named_s);
      std::fprintf(stderr, "%s, seed %d: %s\n", kind, static_cast<int>(seed),
                   outcome->said.empty() ? "nothing is said" : outcome->said.c_str());
    }
    if (cases == 0) continue;
    std::sort(after_s.begin(), after_s.end());
    BenchRow row = held_row(kind, "readings alone", 1 - static_cast<double>(named) / cases, 0.05);
    row.seconds = std::chrono::duration<double>(Clock::now() - started).count() / cases;
    row.further = {
        {"cases", fmt::format("{}", cases)},
        {"named", fmt::format("{}", named)},
        {"among_several", fmt::format("{}", among)},
        {"another_named", fmt::format("{}", wrong)},
        {"after_s",
         after_s.empty() ? "" : fmt::format("{:.0f} / {:.0f}", after_s[after_s.size() / 2], after_s.back())}};
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Alarms of a show in which nothing fails.
struct QuietShow {
  double hours = 0;
  int corrections = 0;
  std::vector<std::string> alarms{};  ///< each when it began
};

QuietShow quiet_show(const Session& session, const LightModel& model, std::uint64_t seed, double hours) {
  QuietShow show;
  sim::Deviations real = sim::Deviations::real();
  real.seed = seed;
  real.visits_per_hour = 0;
  auto world = sim::World::make(session.rig, real, kHoldError);
  if (!world) return show;
  HeldRig rig(session.rig, model, std::move(*world));
  rig.apply(std::vector<double>(session.rig.fixtures.size(), 0.4));
  rig.run(kSettledAfter_s);
  std::string last;
  for (int minute = 0; minute < 60 * hours; ++minute) {
    rig.run(60);
    std::string now;
    for (const Alarm& alarm : rig.status().alarms)
      if (alarm.text.find("readings: ") != std::string::npos) now = alarm.text;
    if (!now.empty() && last.empty())
      show.alarms.push_back(fmt::format("seed {}, after {} min: {}", seed, minute, now));
    last = now;
    show.hours += 1 / 60.0;
  }
  show.corrections = rig.corrections();
  return show;
}

BenchRow quiet_hours(const Session& session, const LightModel& model, const BenchOptions& options) {
  const int seeds = options.seeds.value_or(options.quick ? 2 : 10);
  const double hours = options.seconds ? *options.seconds / 3600 : options.quick ? 0.5 : 100;
  const auto started = Clock::now();
  std::vector<QuietShow> shows(static_cast<std::size_t>(seeds));
  parallel_for(shows.size(), options.threads, [&](std::size_t s) {
    shows[s] = quiet_show(session, model, static_cast<std::uint64_t>(options.first_seed) + s, hours);
  });
  QuietShow all;
  for (const QuietShow& show : shows) {
    all.hours += show.hours;
    all.corrections += show.corrections;
    all.alarms.insert(all.alarms.end(), show.alarms.begin(), show.alarms.end());
  }
  for (const std::string& alarm : all.alarms) std::fprintf(stderr, "%s\n", alarm.c_str());
  BenchRow row = held_row("quiet hours", "readings alone", static_cast<double>(all.alarms.size()), 0);
  row.seconds = std::chrono::duration<double>(Clock::now() - started).count();
  row.further = {{"cases", fmt::format("{:.0f} h", all.hours)}, {"corrections", fmt::format("{}", all.corrections)}};
  return row;
}

/// Lamps in a row, each over its meter, with `cross` of its light on each neighbour's.
MatrixXd crossing_light(Index lamps, double cross) {
  MatrixXd light = MatrixXd::Zero(lamps, lamps);
  for (Index k = 0; k < lamps; ++k)
    for (Index j = std::max<Index>(0, k - 1); j <= std::min(lamps - 1, k + 1); ++j)
      light(k, j) = j == k ? 300 : 300 * cross;
  return light;
}

struct CrossLight {
  Rig rig;
  LightModel model;
  MatrixXd truth;  ///< points, then meters
};

CrossLight cross_light(std::uint64_t seed) {
  constexpr Index kLamps = 6;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit;
  CrossLight cross;
  const MatrixXd light = crossing_light(kLamps, 0.45);
  cross.rig.name = "cross-light";
  cross.rig.buses.resize(2);
  cross.rig.buses[0].name = "lamps";
  cross.rig.buses[1].name = "meters";
  VectorXd level(kLamps);
  for (Index k = 0; k < kLamps; ++k) level[k] = 0.25 + 0.35 * unit(random);
  const VectorXd goals = light * level;
  for (Index k = 0; k < kLamps; ++k) {
    Fixture fixture;
    fixture.name = fmt::format("lamp-{}", k + 1);
    fixture.world_from_mount.translation_m = Vec3(2.0 * static_cast<double>(k), 0, 3);
    cross.rig.fixtures.push_back(fixture);
    Point point;
    point.name = fmt::format("place-{}", k + 1);
    point.position_world_m = Vec3(2.0 * static_cast<double>(k), 0, 0);
    point.goal_lx = goals[k];
    cross.rig.points.push_back(point);
    Luxmeter meter;
    meter.name = fmt::format("meter-{}", k + 1);
    meter.point = static_cast<std::size_t>(k);
    meter.position_world_m = point.position_world_m;
    meter.tolerance = 0.04;
    meter.bus = 1;
    cross.rig.luxmeters.push_back(meter);
  }
  cross.model.point_lux_per_level = cross.model.meter_lux_per_level = light;
  cross.truth.resize(2 * kLamps, kLamps);
  for (Index j = 0; j < kLamps; ++j) {
    const double output = 0.8 + 0.25 * unit(random);
    for (Index k = 0; k < kLamps; ++k) cross.truth(k, j) = cross.truth(kLamps + k, j) = output * light(k, j);
  }
  return cross;
}

struct Held {
  double worst = 0;      ///< error of a goal at the end
  double overshoot = 0;  ///< most light above a goal once all had been within 5 %, or after 20 s
  int corrections = 0;
};

Held held(HeldRig& rig, const CrossLight& cross, double length_s, const std::function<void()>& every_half_second) {
  Held outcome;
  bool near = false;
  for (double t = 0; t < length_s; t += 0.5) {
    if (every_half_second) every_half_second();
    rig.run(0.5);
    const auto points = rig.world().points();
    double worst = 0, over = 0;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const double off = points[p].lux / *cross.rig.points[p].goal_lx - 1;
      worst = std::max(worst, std::abs(off));
      over = std::max(over, off);
    }
    near = near || worst < 0.05 || t > 20;
    if (near) outcome.overshoot = std::max(outcome.overshoot, over);
    outcome.worst = worst;
  }
  return outcome;
}

/// Each meter drives its own lamp: level += gain · (error) + …, with the meter's own light as all it knows.
class PiLoops {
 public:
  explicit PiLoops(const CrossLight& cross) : cross_(cross), sum_(cross.rig.fixtures.size(), 0.0), level_(sum_) {}

  void step(const sim::World& world) {
    for (std::size_t k = 0; k < level_.size(); ++k) {
      const double per_level = cross_.model.meter_lux_per_level(static_cast<Index>(k), static_cast<Index>(k));
      const double error = (*cross_.rig.points[k].goal_lx - world.meter_reading_lx(k)) / per_level;
      sum_[k] = std::clamp(sum_[k] + kIntegral * error, 0.0, 1.0);
      level_[k] = std::clamp(kProportional * error + sum_[k], 0.0, 1.0);
    }
  }
  [[nodiscard]] const std::vector<double>& level() const { return level_; }

 private:
  /// Ziegler and Nichols (1942), for a lamp alone under a meter that answers after a second, stepped twice a second.
  static constexpr double kProportional = 0.45, kIntegral = 0.16;
  const CrossLight& cross_;
  std::vector<double> sum_, level_;
};

std::vector<BenchRow> crossing_rows(const BenchOptions& options) {
  constexpr double kLength_s = 120;
  const int seeds = options.seeds.value_or(options.quick ? 3 : 20);
  std::vector<BenchRow> rows;
  for (const char* method : {"open loop", "PI on each meter", "luxrig"}) {
    const auto started = Clock::now();
    double worst = 0, overshoot = 0;
    int corrections = 0;
    for (int s = 0; s < seeds; ++s) {
      const CrossLight cross = cross_light(static_cast<std::uint64_t>(options.first_seed + s));
      sim::Deviations slow = sim::Deviations::none();
      slow.seed = static_cast<std::uint64_t>(options.first_seed + s);
      slow.meter_noise = 0.003;
      slow.meter_lag_s = 0.15;
      slow.meter_latency_min_s = slow.meter_latency_max_s = 1;
      auto world = sim::World::make(cross.rig, slow, cross.truth);
      if (!world) continue;
      HeldRig rig(cross.rig, cross.model, std::move(*world));
      VectorXd goals(static_cast<Index>(cross.rig.points.size()));
      for (Index p = 0; p < goals.size(); ++p) goals[p] = *cross.rig.points[static_cast<std::size_t>(p)].goal_lx;
      const VectorXd planned = cross.model.point_lux_per_level.fullPivLu().solve(goals);
      const std::vector<double> plan(planned.data(), planned.data() + planned.size());
      PiLoops loops(cross);
      std::vector<double> driven = plan;
      Held outcome;
      if (std::string(method) == "luxrig") {
        rig.apply(plan);
        outcome = held(rig, cross, kLength_s, {});
        corrections = std::max(corrections, rig.status().round);
      } else {
        rig.on_the_way = [&](std::vector<LevelCommand>& commands) {
          for (LevelCommand& command : commands)
            command.drive = drive_for(cross.rig.fixtures[command.fixture], driven[command.fixture]);
        };
        const bool closed = std::string(method) != "open loop";
        if (closed) driven.assign(driven.size(), 0.0);
        outcome = held(rig, cross, kLength_s, [&] {
          if (!closed) return;
          loops.step(rig.world());
          driven = loops.level();
        });
      }
      worst = std::max(worst, outcome.worst);
      overshoot = std::max(overshoot, outcome.overshoot);
    }
    BenchRow row = held_row("cross-light 45 %", method, worst, 0.02);
    if (std::string(method) != "luxrig") row.target_error.reset();
    row.seconds = std::chrono::duration<double>(Clock::now() - started).count() / seeds;
    row.further = {{"cases", fmt::format("{}", seeds)},
                   {"overshoot", fmt::format("{:.3f}", overshoot)},
                   {"corrections", std::string(method) == "luxrig" ? fmt::format("{}", corrections) : ""}};
    rows.push_back(std::move(row));
  }
  return rows;
}

struct TracedSession {
  Session session;
  TransportMatrix light;
};

/// The first rig of the options, changed so; none = it is told why.
std::optional<TracedSession> session_for(const BenchOptions& options, const std::function<Rig(Rig)>& changed) {
  auto rig = load_rig(options.rigs.empty() ? "rigs/gallery/rig.toml" : options.rigs.front());
  auto session = rig ? session_of(changed(std::move(*rig))) : tl::unexpected(rig.error());
  if (!session) {
    for (const Problem& problem : session.error()) std::fprintf(stderr, "%s\n", problem.text().c_str());
    return std::nullopt;
  }
  ComputeOptions compute;
  compute.max_error = kHoldError;
  compute.threads = options.threads;
  auto light = compute_transport(*session, compute);
  if (light) return TracedSession{std::move(*session), std::move(*light)};
  std::fprintf(stderr, "%s\n", light.error().detail.c_str());
  return std::nullopt;
}

std::vector<BenchRow> year_rows(const BenchOptions& options) {
  const auto daylit = session_for(options, with_blinded_daylight);
  if (!daylit) return {};
  return {simulated_year(daylit->session, daylit->light, options)};
}

}  // namespace

std::vector<BenchRow> bench_hold(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  const auto wanted = [&](const char* part) { return std::string(part).starts_with(options.only); };
  const auto add = [&](std::vector<BenchRow> more) {
    rows.insert(rows.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  };
  if (wanted("cross-light")) add(crossing_rows(options));
  if (wanted("year")) add(year_rows(options));
  if (wanted("faults") || wanted("quiet hours")) {
    const auto measured = session_for(options, [](Rig rig) { return rig; });
    if (!measured) return rows;
    const LightModel model = light_model(measured->session.rig, measured->light);
    if (wanted("faults")) add(named_faults(measured->session, model, options));
    if (wanted("quiet hours")) add({quiet_hours(measured->session, model, options)});
  }
  // One header: every row has every column.
  for (BenchRow& row : rows) {
    std::vector<std::pair<std::string, std::string>> all;
    for (const char* column : {"cases", "named", "among_several", "another_named", "after_s", "overshoot",
                               "corrections", "goals", "at_meters", "of_limit", "exceeded", "looks", "kwh", "digest"}) {
      const auto has =
          std::find_if(row.further.begin(), row.further.end(), [&](const auto& c) { return c.first == column; });
      all.emplace_back(column, has == row.further.end() ? "" : has->second);
    }
    row.further = std::move(all);
  }
  return rows;
}

}  // namespace luxrig
