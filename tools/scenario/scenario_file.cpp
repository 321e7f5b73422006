#include "tools/scenario/scenario_file.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <charconv>
#include <set>

#include "core/rig/reading/section.h"
#include "core/text/nearest.h"
#include "sim/world/deviations_text.h"
#include "tools/recording/of_rig.h"
#include "tools/scenario/condition.h"
#include "tools/scenario/desk.h"
#include "tools/scenario/replay.h"

namespace luxrig::scenario {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20, kMaxSeeds = 100'000;

using What = Event::What;

/// What an action needs, beside its time.
struct Needs {
  What what;
  enum class On { none, may, must } on;
  enum class Value { none, must } value;
  double min, max;  ///< of the value
  bool lasts;       ///< takes for_s
  std::string_view names;
};
constexpr Needs kNeeds[] = {
    {What::apply, Needs::On::none, Needs::Value::none, 0, 0, false, ""},
    {What::blackout, Needs::On::none, Needs::Value::none, 0, 0, true, ""},
    {What::lift_blackout, Needs::On::none, Needs::Value::none, 0, 0, false, ""},
    {What::level, Needs::On::must, Needs::Value::must, 0, 1, true, "fixtures"},
    {What::goal, Needs::On::must, Needs::Value::must, 0, 1e6, true, "points"},
    {What::release, Needs::On::may, Needs::Value::none, 0, 0, false, "fixtures and points"},
    {What::park, Needs::On::may, Needs::Value::none, 0, 0, false, "fixtures"},
    {What::bypass, Needs::On::must, Needs::Value::none, 0, 0, true, "fixtures and luxmeters"},
    {What::end_bypass, Needs::On::must, Needs::Value::none, 0, 0, false, "fixtures and luxmeters"},
    {What::desk, Needs::On::must, Needs::Value::must, 0, 1, true, "fixtures on a bus that listens to a desk"},
    {What::cover, Needs::On::must, Needs::Value::must, 0, 1, true, "luxmeters"},
    {What::shade, Needs::On::must, Needs::Value::must, 0, 1, true, "points"},
    {What::daylight, Needs::On::none, Needs::Value::must, 0, 1000, true, ""},
    {What::clock_step, Needs::On::none, Needs::Value::must, -1e6, 1e6, false, ""},
    {What::replay, Needs::On::none, Needs::Value::none, 0, 0, true, ""},
    {What::stop, Needs::On::none, Needs::Value::none, 0, 0, true, ""},
    {What::kill, Needs::On::none, Needs::Value::none, 0, 0, true, ""},
    {What::power_cut, Needs::On::none, Needs::Value::none, 0, 0, true, ""},
    {What::kill_guardian, Needs::On::none, Needs::Value::none, 0, 0, false, ""},
    {What::fault, Needs::On::must, Needs::Value::none, 0, 0, true, "devices"},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < std::size(kNeeds); ++i)
    if (kNeeds[i].what != static_cast<What>(i)) return false;
  return std::size(kNeeds) == static_cast<std::size_t>(What::fault) + 1;
}
static_assert(in_order(), "kNeeds is indexed by What");

constexpr std::string_view kKinds[] = {"always", "never", "reached", "at_end"};  // by Expectation::Kind

template <class Items>
void add_names(const Items& items, std::vector<std::string>& names) {
  for (const auto& item : items) names.push_back(item.name);
}

class ScenarioReader {
 public:
  ScenarioReader(const NodeTable& root, const std::filesystem::path& file, const Rig& rig)
      : root_(root), rig_(rig), folder_(file.parent_path()), problems_(file.string()) {
    scenario_.file = file;
  }

  Checked<Scenario> read() {
    report_unknown_sections(root_, SectionSpec::File::scenario, "a scenario", problems_);
    if (!find(root_, "scenario"))
      problems_.add({1, 1}, "there is no [scenario]", "begin with [scenario] and its name and length_s below it");
    each_section(root_, "scenario", problems_, [&](Section& s) { read_scenario(s); });
    each_section(root_, "event", problems_, [&](Section& s) { read_event(s); });
    each_section(root_, "expect", problems_, [&](Section& s) { read_expectation(s); });
    if (!problems_.empty()) return tl::unexpected(problems_.take());
    return std::move(scenario_);
  }

 private:
  void read_scenario(Section& s) {
    s.read("name", scenario_.name);
    s.read("length_s", scenario_.length_s);
    std::string seeds = "1";
    s.read("seeds", seeds);
    scenario_.seeds = parse_seeds(seeds);
    if (scenario_.seeds.empty())
      problems_.add(s.place_of("seeds"), fmt::format("seeds cannot be {}", in_quotes(seeds)),
                    R"(write "7", "1..20" or "1, 5, 9..12", at most 100000 of them)");
    if (s.read("deviations", scenario_.deviations_text)) {
      auto deviations = sim::parse_deviations(scenario_.deviations_text);
      if (deviations)
        scenario_.deviations = *deviations;
      else
        for (const Problem& problem : deviations.error())
          problems_.add(s.place_of("deviations"), problem.what, problem.mend);
    }
    enum class Start { solved, dark } start = Start::solved;
    s.read_choice("start", start);
    scenario_.starts_dark = start == Start::dark;
  }

  void read_event(Section& s) {
    Event event;
    event.in_file = s.in_file();
    if (s.read("name", event.name) && !names_.emplace(event.name).second)
      problems_.add(s.place_of("name"), fmt::format("a second event is called {}", in_quotes(event.name)),
                    "give each its own name");
    read_time(s, event);
    const bool faulty = s.has("fault");
    if (faulty == s.has("do")) {
      problems_.add(s.in_file(), faulty ? "this event has both a fault and an action" : "this event does nothing",
                    faulty ? "make two events of them" : "give it `fault` or `do`");
    } else if (faulty) {
      read_fault(s, event);
    } else if (s.read_choice("do", event.what)) {
      read_action(s, event);
    }
    scenario_.events.push_back(std::move(event));
  }

  void read_time(Section& s, Event& event) {
    const int ways = int{s.has("at_s")} + int{s.has("after")} + int{s.has("when")};
    if (ways != 1)
      problems_.add(s.in_file(), ways == 0 ? "nothing says when this happens" : "this event has more than one time",
                    "give it one of `at_s`, `after` and `when`");
    if (s.has("at_s")) s.refuse("after_s", "after_s has no effect with at_s", "remove it");
    s.read("at_s", event.at_s);
    if (s.read("after_s", event.at_s) && s.has("at_s")) return;
    if (s.has("after")) event.after = read_after(s);
    std::string text;
    if (s.read("when", text)) event.when = parse_condition(text, s.place_of("when"), rig_, problems_);
    if (scenario_.length_s > 0 && event.at_s >= scenario_.length_s)
      problems_.add(s.has("at_s") ? s.place_of("at_s") : s.place_of("after_s"),
                    fmt::format("that is not before the end of the show at {:g} s", scenario_.length_s),
                    "let it happen sooner, or raise length_s");
  }

  /// The earlier event that this section follows.
  std::optional<std::size_t> read_after(Section& s) {
    std::string name;
    if (!s.read("after", name)) return std::nullopt;
    std::vector<std::string_view> known;
    for (std::size_t e = 0; e < scenario_.events.size(); ++e) {
      if (scenario_.events[e].name == name) return e;
      if (!scenario_.events[e].name.empty()) known.emplace_back(scenario_.events[e].name);
    }
    problems_.add(s.place_of("after"), fmt::format("no event above is called {}", in_quotes(name)),
                  mend_for_unknown(name, known, "give the event a name"));
    return std::nullopt;
  }

  void read_fault(Section& s, Event& event) {
    event.what = What::fault;
    std::string fault;
    s.read("value", event.value);
    s.read("for_s", event.for_s);
    s.refuse("plan", "plan has no effect: only do = \"apply\" takes one", "remove it");
    s.refuse("refused", "nobody can refuse a fault", "remove it");
    s.refuse("recording", "recording has no effect on a fault", "remove it");
    for (const char* key : {"pan_deg", "tilt_deg"})
      s.refuse(key, fmt::format("{} has no effect: only a desk turns heads", key), "remove it");
    std::vector<std::string> known;
    add_names(rig_.fixtures, known);
    add_names(rig_.luxmeters, known);
    add_names(rig_.buses, known);
    for (const Fixture& fixture : rig_.fixtures) {
      if (!fixture.axes) continue;
      known.push_back(pan_axis_name(fixture));
      known.push_back(tilt_axis_name(fixture));
    }
    read_names(s, event, known, kNeeds[static_cast<std::size_t>(What::fault)]);
    if (!s.read("fault", fault)) return;
    const auto kind = sim::fault_named(fault);
    if (!kind) {
      std::vector<std::string_view> names;
      for (const sim::FaultKind each : sim::all_faults()) names.push_back(sim::name_of(each));
      problems_.add(s.place_of("fault"), fmt::format("unknown fault {}", in_quotes(fault)),
                    mend_for_unknown(fault, names, ""));
      return;
    }
    event.fault = *kind;
    sim::Faults checked;
    for (const std::string& name : event.on)
      if (const auto set = checked.set_named(rig_, name, fault, true, event.value); !set) {
        const std::string& detail = set.error().detail;
        const std::size_t colon = detail.rfind(": ");
        problems_.add(s.place_of("value"), detail.substr(0, colon), detail.substr(colon + 2));
        return;
      }
  }

  void read_action(Section& s, Event& event) {
    const Needs& needs = kNeeds[static_cast<std::size_t>(event.what)];
    const std::string_view action = name_of(event.what);
    std::vector<std::string> known;
    const bool goal_like = event.what == What::goal || event.what == What::shade;
    if (goal_like || event.what == What::release) add_names(rig_.points, known);
    if (event.what == What::level || event.what == What::release || event.what == What::park || is_bypass(event.what))
      add_names(rig_.fixtures, known);
    if (event.what == What::cover || is_bypass(event.what)) add_names(rig_.luxmeters, known);
    if (event.what == What::desk)
      for (const Fixture& fixture : rig_.fixtures) known.push_back(fixture.name);
    read_names(s, event, known, needs);
    if (needs.value == Needs::Value::none) {
      s.refuse("value", fmt::format("value has no effect on {}", action), "remove it");
    } else if (!s.has("value")) {
      s.require("value", fmt::format("which {} needs", action));
    } else if (s.read("value", event.value) && !(*event.value >= needs.min && *event.value <= needs.max)) {
      problems_.add(s.place_of("value"), fmt::format("value {:g} of {} is out of range", *event.value, action),
                    fmt::format("allowed: {:g} to {:g}", needs.min, needs.max));
    }
    if (!needs.lasts) s.refuse("for_s", fmt::format("for_s has no effect on {}", action), "remove it");
    s.read("for_s", event.for_s);
    if (!is_command(event.what)) s.refuse("refused", fmt::format("nobody can refuse {}", action), "remove it");
    s.read("refused", event.refused);
    std::string plan;
    if (event.what != What::apply) s.refuse("plan", "plan has no effect: only do = \"apply\" takes one", "remove it");
    if (s.read("plan", plan) && event.what == What::apply) event.plan = folder_ / plan;
    read_recording(s, event);
    if (event.what == What::desk) {
      for (const std::size_t f : event.which)
        if (!desk_rules(rig_.buses[rig_.fixtures[f].bus])) {
          problems_.add(s.place_of("on"),
                        fmt::format("bus {} of fixture {} listens to no desk",
                                    in_quotes(rig_.buses[rig_.fixtures[f].bus].name), in_quotes(rig_.fixtures[f].name)),
                        "give the bus `input` in the rig file");
          break;
        }
      double pan_rad = 0, tilt_rad = 0;
      if (s.read_deg("pan_deg", pan_rad)) event.pan_rad = pan_rad;
      if (s.read_deg("tilt_deg", tilt_rad)) event.tilt_rad = tilt_rad;
    } else {
      for (const char* key : {"pan_deg", "tilt_deg"})
        s.refuse(key, fmt::format("{} has no effect: only a desk turns heads", key), "remove it");
    }
    if (event.what == What::daylight && !rig_.daylight)
      problems_.add(s.place_of("do"), "this rig has no daylight", "add [daylight] to the rig file");
  }

  void read_recording(Section& s, Event& event) {
    if (event.what != What::replay)
      return s.refuse("recording", "recording has no effect: only do = \"replay\" takes one", "remove it");
    std::string file;
    if (!s.has("recording")) return s.require("recording", "which replay needs");
    if (!s.read("recording", file)) return;
    event.recording_file = file;
    auto recorded = recording::read_recording(folder_ / file, recording::modbus_ports(rig_));
    if (!recorded) {
      for (const Problem& problem : recorded.error()) {
        const std::string line = problem.line > 0 ? fmt::format("line {}: ", problem.line) : "";
        problems_.add(s.place_of("recording"), fmt::format("{}: {}{}", in_quotes(file), line, problem.what),
                      problem.mend);
      }
      return;
    }
    event.recording = std::make_shared<const recording::Recording>(std::move(*recorded));
    if (!Replay(rig_, event.recording, Time{}).concerns_the_rig())
      problems_.add(
          s.place_of("recording"),
          fmt::format("nothing in {} is for this rig: no desk of a bus with `input`, no reading of its meters",
                      in_quotes(file)),
          "luxrig replay FILE --info says what is in it");
  }

  static bool is_bypass(What what) { return what == What::bypass || what == What::end_bypass; }

  void read_names(Section& s, Event& event, const std::vector<std::string>& known, const Needs& needs) {
    if (needs.on == Needs::On::none)
      return s.refuse("on", fmt::format("on has no effect on {}", name_of(event.what)), "remove it");
    if (needs.on == Needs::On::must && !s.has("on")) return s.require("on", fmt::format("naming {}", needs.names));
    std::vector<std::pair<std::string, FilePosition>> patterns;
    const bool read = s.read_texts("on", patterns);
    for (const auto& [pattern, in_file] : patterns) {
      const std::size_t before = event.on.size();
      for (std::size_t i = 0; i < known.size(); ++i) {
        if (known[i] != pattern && fnmatch(pattern.c_str(), known[i].c_str(), 0) != 0) continue;
        event.on.push_back(known[i]);
        if (event.what == What::cover || event.what == What::shade || event.what == What::desk)
          event.which.push_back(i);
      }
      if (event.on.size() > before) continue;
      const std::vector<std::string_view> views(known.begin(), known.end());
      problems_.add(in_file, fmt::format("{} fits none of the {}", in_quotes(pattern), needs.names),
                    mend_for_unknown(pattern, views, fmt::format("the rig has no {}", needs.names)));
    }
    if (read && patterns.empty() && needs.on == Needs::On::must)
      problems_.add(s.place_of("on"), "on is empty", fmt::format("name {}", needs.names));
  }

  void read_expectation(Section& s) {
    Expectation expectation;
    expectation.in_file = s.in_file();
    int kinds = 0;
    for (std::size_t k = 0; k < std::size(kKinds); ++k) {
      std::string text;
      if (!s.has(kKinds[k])) continue;
      ++kinds;
      expectation.kind = static_cast<Expectation::Kind>(k);
      if (!s.read(kKinds[k], text)) continue;
      if (auto condition = parse_condition(text, s.place_of(kKinds[k]), rig_, problems_))
        expectation.condition = std::move(*condition);
    }
    if (kinds != 1)
      problems_.add(s.in_file(), kinds == 0 ? "this expectation expects nothing" : "this expectation has more than one",
                    "give it one of `always`, `never`, `reached` and `at_end`");
    if (s.has("after")) expectation.after = read_after(s);
    s.read("from_s", expectation.from_s);
    s.read("within_s", expectation.within_s);
    s.read("why", expectation.why);
    if (scenario_.length_s > 0 && expectation.from_s >= scenario_.length_s)
      problems_.add(s.place_of("from_s"), fmt::format("the show is over at {:g} s", scenario_.length_s),
                    "begin sooner, or raise length_s");
    if (!expectation.after && expectation.within_s && scenario_.length_s > 0 &&
        expectation.from_s + *expectation.within_s > scenario_.length_s)
      problems_.add(s.place_of("within_s"),
                    fmt::format("the show is over at {:g} s, before that time", scenario_.length_s),
                    "lower it, or raise length_s");
    scenario_.expectations.push_back(std::move(expectation));
  }

  const NodeTable& root_;
  const Rig& rig_;
  std::filesystem::path folder_;
  ProblemList problems_;
  Scenario scenario_;
  std::set<std::string> names_;
};

}  // namespace

std::string_view name_of(Expectation::Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::string_view name_of(Event::What what) {
  static const std::vector<std::string_view> names = [] {
    const std::span<const KeySpec> keys = keys_of("event");
    auto choices =
        choices_of(*std::find_if(keys.begin(), keys.end(), [](const KeySpec& key) { return key.key == "do"; }));
    choices.emplace_back("fault");
    return choices;
  }();
  return names.at(static_cast<std::size_t>(what));
}

std::string Expectation::text() const { return fmt::format("{} {}", name_of(kind), condition.written); }

std::vector<std::uint64_t> parse_seeds(std::string_view text) {
  std::set<std::uint64_t> seeds;
  const auto number = [&](std::uint64_t& out) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
  };
  const auto spaces = [&] { text.remove_prefix(std::min(text.find_first_not_of(' '), text.size())); };
  for (;;) {
    std::uint64_t from = 0, to = 0;
    spaces();
    if (!number(from)) return {};
    to = from;
    if (text.starts_with("..")) {
      text.remove_prefix(2);
      if (!number(to)) return {};
    }
    if (to < from || to - from >= kMaxSeeds) return {};
    for (std::uint64_t seed = from; seed - from <= to - from; ++seed) {
      seeds.insert(seed);
      if (seed == to) break;
    }
    if (seeds.size() > kMaxSeeds) return {};
    spaces();
    if (text.empty()) return {seeds.begin(), seeds.end()};
    if (text.front() != ',') return {};
    text.remove_prefix(1);
  }
}

Checked<Scenario> parse_scenario(std::string_view text, const std::filesystem::path& file, const Rig& rig) {
  if (text.size() > kMaxBytes)
    return tl::unexpected(std::vector<Problem>{
        {file.string(), 0, 0, fmt::format("the file has {} bytes", text.size()), "a scenario may have at most 1 MiB"}});
  const auto document = parse_document(text, file.string());
  if (!document) return tl::unexpected(document.error());
  return ScenarioReader(*document, file, rig).read();
}

}  // namespace luxrig::scenario
