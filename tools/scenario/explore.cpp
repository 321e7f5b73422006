#include "tools/scenario/explore.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <set>

#include "tools/scenario/desk.h"
#include "tools/scenario/jobs.h"
#include "tools/scenario/stepped_show.h"

namespace luxrig::scenario {
namespace {

using Clock = std::chrono::steady_clock;
using What = Event::What;

constexpr std::size_t kShowsPerJob = 8;

class ShowDrawer {
 public:
  ShowDrawer(const Rig& rig, std::uint64_t seed, double length_s) : rig_(rig), length_s_(length_s), random_(seed) {
    for (const sim::FaultKind fault : sim::all_faults())
      if (acts_without_wires(fault)) faults_.push_back(fault);
    for (const Fixture& fixture : rig.fixtures) fixtures_.push_back(fixture.name);
    for (const Luxmeter& meter : rig.luxmeters) meters_.push_back(meter.name);
    for (const Point& point : rig.points) points_.push_back(point.name);
    for (const Bus& bus : rig.buses) buses_.push_back(bus.name);
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
      if (desk_rules(rig.buses[rig.fixtures[f].bus])) desk_fixtures_.push_back(f);
  }

  std::vector<Event> events() {
    std::vector<Event> events(2 + below(9));
    for (std::size_t e = 0; e < events.size(); ++e) {
      events[e] = event();
      events[e].at_s = time_near(events, e);
    }
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.at_s < b.at_s; });
    return events;
  }

 private:
  std::size_t below(std::size_t count) { return random_() % count; }
  /// A multiple of 0.1 s: files stay short.
  double tenths(double from, double to) {
    return std::round(10 * (from + (to - from) * static_cast<double>(random_() >> 11) * 0x1p-53)) / 10;
  }
  std::string one_of(const std::vector<std::string>& names) { return names[below(names.size())]; }

  /// Most mistakes show while something goes on: at the start, and soon after another event or its end.
  double time_near(const std::vector<Event>& events, std::size_t e) {
    const std::size_t kind = below(4);
    if (kind == 0) return tenths(0, 6);
    if (kind == 1 || e == 0) return tenths(1, length_s_ - 5);
    const Event& other = events[below(e)];
    const double begins_s = other.at_s + (kind == 2 ? 0 : other.for_s.value_or(0));
    return std::min(std::round(10 * begins_s) / 10 + tenths(0, 3), std::round(length_s_ - 5));
  }

  Event event() {
    Event event;
    if (below(2) == 0) {
      event.what = What::fault;
      event.fault = faults_[below(faults_.size())];
      const bool of_meter = event.fault == sim::FaultKind::stuck || event.fault == sim::FaultKind::lying;
      const std::size_t kind = meters_.empty() ? below(2) : of_meter ? 2 : below(3);
      event.on = {one_of(kind == 0 ? buses_ : kind == 1 ? fixtures_ : meters_)};
      if (event.fault == sim::FaultKind::lying) event.value = tenths(0, 2);
      if (event.fault == sim::FaultKind::lost) event.value = tenths(0.1, 1);
      if (event.fault == sim::FaultKind::slow) event.value = tenths(50, 3000);
      if (below(4) != 0) event.for_s = tenths(0.2, 30);
      return event;
    }
    struct Chance {
      What what;
      std::size_t weight;
    };
    if (!desk_fixtures_.empty() && below(5) == 0) {
      event.what = What::desk;
      event.which = {desk_fixtures_[below(desk_fixtures_.size())]};
      event.on = {fixtures_[event.which[0]]};
      event.value = tenths(0, 1);
      event.for_s = tenths(1, 30);
      if (rig_.fixtures[event.which[0]].moves) {
        event.pan_rad = rad_from_deg(tenths(-180, 180));
        event.tilt_rad = rad_from_deg(tenths(-90, 90));
      }
      return event;
    }
    constexpr Chance chances[] = {{What::blackout, 3},  {What::level, 4}, {What::goal, 3},   {What::release, 1},
                                  {What::apply, 2},     {What::park, 1},  {What::bypass, 2}, {What::cover, 2},
                                  {What::shade, 2},     {What::stop, 1},  {What::kill, 2},   {What::power_cut, 1},
                                  {What::clock_step, 1}};
    std::size_t all = 0;
    for (const Chance& chance : chances) all += chance.weight;
    std::size_t at = below(all);
    const Chance* drawn = chances;
    while (at >= drawn->weight) at -= (drawn++)->weight;
    event.what = drawn->what;
    if ((event.what == What::cover && meters_.empty()) || (event.what == What::shade && points_.empty()) ||
        (event.what == What::goal && points_.empty()))
      event.what = What::blackout;
    switch (event.what) {
      case What::level:
        event.on = {one_of(fixtures_)};
        event.value = tenths(0, 1);
        if (below(2) == 0) event.for_s = tenths(1, 30);
        break;
      case What::goal: {
        const std::size_t p = below(points_.size());
        event.on = {points_[p]};
        event.value = std::round(rig_.points[p].goal_lx.value_or(100) * tenths(0, 2));
        break;
      }
      case What::bypass:
        event.on = {one_of(meters_.empty() || below(2) == 0 ? fixtures_ : meters_)};
        event.for_s = tenths(1, 30);
        break;
      case What::cover:
        event.which = {below(meters_.size())};
        event.on = {meters_[event.which[0]]};
        event.value = tenths(0, 0.9);
        event.for_s = tenths(1, 30);
        break;
      case What::shade:
        event.which = {below(points_.size())};
        event.on = {points_[event.which[0]]};
        event.value = tenths(0, 0.9);
        event.for_s = tenths(1, 30);
        break;
      case What::blackout:
        if (below(4) != 0) event.for_s = tenths(0.2, 20);
        break;
      case What::clock_step:
        event.value = std::round(tenths(-1e5, 1e5));
        break;
      case What::stop:
      case What::kill:
      case What::power_cut:
        event.for_s = tenths(0.2, 5);
        break;
      default:
        break;
    }
    return event;
  }

  const Rig& rig_;
  double length_s_;
  std::mt19937_64 random_;
  std::vector<sim::FaultKind> faults_;
  std::vector<std::string> fixtures_, meters_, points_, buses_;
  std::vector<std::size_t> desk_fixtures_;  ///< on a bus that listens to a desk
};

/// The rule that a run broke; empty if none. A refused command is no failure here.
std::string broken_rule(const Outcome& outcome) {
  for (const Judged& rule : outcome.rules)
    if (!rule.held) return rule.expected;
  return outcome.error.empty() ? "" : "the daemon runs";
}

std::string broken_rule_of(const PreparedRig& rig, const Scenario& scenario) {
  return broken_rule(run_stepped(rig, scenario, scenario.seeds.front(), {false, false}));
}

/// Leaves out ever smaller parts, then the ends of what lasts, then the end of the show.
Scenario smallest(const PreparedRig& rig, Scenario scenario, const std::string& rule) {
  const auto still = [&](const Scenario& tried) { return broken_rule_of(rig, tried) == rule; };
  for (std::size_t part = std::max<std::size_t>(1, scenario.events.size() / 2);;
       part = std::max<std::size_t>(1, part / 2)) {
    bool shorter = false;
    for (std::size_t at = 0; at < scenario.events.size();) {
      Scenario tried = scenario;
      tried.events.erase(tried.events.begin() + static_cast<std::ptrdiff_t>(at),
                         tried.events.begin() + static_cast<std::ptrdiff_t>(std::min(at + part, tried.events.size())));
      if (still(tried)) {
        scenario = std::move(tried);
        shorter = true;
      } else {
        at += part;
      }
    }
    if (part == 1 && !shorter) break;
  }
  for (Event& event : scenario.events) {
    if (event.what != What::fault && event.what != What::blackout && event.what != What::level) continue;
    const auto for_s = event.for_s;
    event.for_s.reset();
    if (!still(scenario)) event.for_s = for_s;
  }
  const Outcome outcome = run_stepped(rig, scenario, scenario.seeds.front(), {false, false});
  for (const Judged& judged : outcome.rules) {
    if (judged.held || judged.expected != rule || !judged.at_s) continue;
    Scenario tried = scenario;
    tried.length_s = std::ceil(*judged.at_s) + 1;
    // What begins after the end is no part of it.
    std::erase_if(tried.events, [&](const Event& event) { return event.at_s >= tried.length_s; });
    if (tried.length_s < scenario.length_s && still(tried)) scenario = std::move(tried);
  }
  return scenario;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

Scenario random_show(const Rig& rig, std::uint64_t seed, double length_s) {
  Scenario scenario;
  scenario.name = fmt::format("found by exploring, show {}", seed);
  scenario.file = fmt::format("explored-{}.toml", seed);
  scenario.length_s = length_s;
  scenario.seeds = {1 + seed % 97};
  scenario.events = ShowDrawer(rig, seed, length_s).events();
  return scenario;
}

Explored explore(const PreparedRig& rig, const ExploreOptions& options,
                 const std::function<void(const Explored&)>& told) {
  const auto end = Clock::now() + std::chrono::duration<double>(60 * options.minutes);
  Explored explored;
  std::set<std::string> broken;  // rules
  const Rig& in = rig.session->rig;
  while (Clock::now() < end && explored.shows < options.max_shows) {
    const std::uint64_t from = options.seed + explored.shows;
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(
        kShowsPerJob * static_cast<std::size_t>(std::max(1, options.jobs)), options.max_shows - explored.shows));
    const auto outcomes = run_all(count, options.jobs, [&](std::size_t i) {
      const Scenario show = random_show(in, from + i, options.length_s);
      return run_stepped(rig, show, show.seeds.front(), {false, false});
    });
    for (std::size_t i = 0; i < count; ++i) {
      const std::string rule = broken_rule(outcomes[i]);
      if (rule.empty() || !broken.insert(rule).second) continue;
      Finding finding;
      finding.rule = rule;
      finding.scenario = smallest(rig, random_show(in, from + i, options.length_s), rule);
      finding.outcome = run_stepped(rig, finding.scenario, finding.scenario.seeds.front(), {true, false});
      for (const std::size_t e : finding.outcome.refused) finding.scenario.events[e].refused = true;
      explored.findings.push_back(std::move(finding));
    }
    explored.shows += count;
    if (told) told(explored);
  }
  return explored;
}

std::string to_toml(const Scenario& scenario) {
  std::vector<std::string> seeds;
  for (const std::uint64_t seed : scenario.seeds) seeds.push_back(fmt::format("{}", seed));
  std::string out = fmt::format("[scenario]\nname = {}\nlength_s = {}\nseeds = \"{}\"\n", quoted(scenario.name),
                                scenario.length_s, fmt::join(seeds, ", "));
  if (scenario.starts_dark) out += "start = \"dark\"\n";
  if (scenario.deviations_text != "mild") out += fmt::format("deviations = {}\n", quoted(scenario.deviations_text));
  const auto names_of = [](const std::vector<std::string>& names) {
    std::vector<std::string> all;
    for (const std::string& name : names) all.push_back(quoted(name));
    return fmt::format("[{}]", fmt::join(all, ", "));
  };
  for (const Event& event : scenario.events) {
    out += "\n[[event]]\n";
    if (!event.name.empty()) out += fmt::format("name = {}\n", quoted(event.name));
    if (event.when) out += fmt::format("when = {}\n", quoted(event.when->written));
    if (event.after) out += fmt::format("after = {}\n", quoted(scenario.events[*event.after].name));
    if (event.when || event.after)
      out += event.at_s > 0 ? fmt::format("after_s = {}\n", event.at_s) : "";
    else
      out += fmt::format("at_s = {}\n", event.at_s);
    out += event.what == What::fault ? fmt::format("fault = \"{}\"\n", sim::name_of(event.fault))
                                     : fmt::format("do = \"{}\"\n", name_of(event.what));
    if (!event.on.empty()) out += fmt::format("on = {}\n", names_of(event.on));
    if (event.value) out += fmt::format("value = {}\n", *event.value);
    if (event.for_s) out += fmt::format("for_s = {}\n", *event.for_s);
    if (event.pan_rad) out += fmt::format("pan_deg = {:.10g}\n", deg_from_rad(*event.pan_rad));
    if (event.tilt_rad) out += fmt::format("tilt_deg = {:.10g}\n", deg_from_rad(*event.tilt_rad));
    if (event.plan) out += fmt::format("plan = {}\n", quoted(event.plan->string()));
    if (event.recording) out += fmt::format("recording = {}\n", quoted(event.recording_file.string()));
    if (event.refused) out += "refused = true\n";
  }
  for (const Expectation& expectation : scenario.expectations) {
    out += fmt::format("\n[[expect]]\n{} = {}\n", name_of(expectation.kind), quoted(expectation.condition.written));
    if (expectation.after) out += fmt::format("after = {}\n", quoted(scenario.events[*expectation.after].name));
    if (expectation.from_s > 0) out += fmt::format("from_s = {}\n", expectation.from_s);
    if (expectation.within_s) out += fmt::format("within_s = {}\n", *expectation.within_s);
    if (!expectation.why.empty()) out += fmt::format("why = {}\n", quoted(expectation.why));
  }
  return out;
}

}  // namespace luxrig::scenario
