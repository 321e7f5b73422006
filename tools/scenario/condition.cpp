#include "tools/scenario/condition.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/geometry.h"
#include "core/text/nearest.h"
#include "core/text/plain_text.h"

namespace luxrig::scenario {
namespace {

using Of = Condition::Of;
using Relation = Condition::Relation;

enum class Names { none, points, luxmeters, fixtures };

struct Subject {
  Of of;
  std::string_view name;
  Names names;
  std::string_view unit;
  bool compared;
};

constexpr Subject kSubjects[] = {
    {Of::lux, "lux", Names::points, "lx", true},
    {Of::reading, "reading", Names::luxmeters, "lx", true},
    {Of::level, "level", Names::fixtures, "", true},
    {Of::pan, "pan", Names::fixtures, "deg", true},
    {Of::tilt, "tilt", Names::fixtures, "deg", true},
    {Of::lux_hours, "lux_hours", Names::points, "lxh", true},
    {Of::met, "met", Names::none, "", true},
    {Of::missed, "missed", Names::none, "", true},
    {Of::unknown, "unknown", Names::none, "", true},
    {Of::alarms, "alarms", Names::none, "", true},
    {Of::phase, "phase", Names::none, "", false},
    {Of::alarm, "alarm", Names::none, "", false},
    {Of::blackout, "blackout", Names::none, "", false},
    {Of::exit, "exit", Names::none, "", true},
};

struct RelationName {
  Relation relation;
  std::string_view name;
};
constexpr RelationName kRelations[] = {
    {Relation::less, "<"},   {Relation::at_most, "<="},   {Relation::more, ">"},         {Relation::at_least, ">="},
    {Relation::equal, "=="}, {Relation::not_equal, "!="}, {Relation::between, "between"}};

const Subject& subject_of(Of of) {
  return *std::find_if(std::begin(kSubjects), std::end(kSubjects), [of](const Subject& s) { return s.of == of; });
}

/// By Phase.
std::vector<std::string_view> phase_names() {
  std::vector<std::string_view> names;
  for (int phase = 0; phase <= static_cast<int>(Phase::safe); ++phase)
    names.emplace_back(luxrig::name_of(static_cast<Phase>(phase)));
  return names;
}

struct Word {
  std::string text;
  std::size_t at = 0;  ///< in the condition
};

/// Words between spaces; a word in quotes may have spaces. An open quote runs to the end.
std::vector<Word> words_of(std::string_view text) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ') {
      ++i;
      continue;
    }
    Word word{{}, i};
    if (text[i] == '"' || text[i] == '\'') {
      const std::size_t end = std::min(text.find(text[i], i + 1), text.size());
      word.text = text.substr(i + 1, end - i - 1);
      i = end + 1;
    } else {
      const std::size_t end = std::min(text.find(' ', i), text.size());
      word.text = text.substr(i, end - i);
      i = end;
    }
    words.push_back(std::move(word));
  }
  return words;
}

std::vector<std::string_view> names_in(const Rig& rig, Names of) {
  std::vector<std::string_view> names;
  if (of == Names::points)
    for (const Point& point : rig.points) names.emplace_back(point.name);
  if (of == Names::luxmeters)
    for (const Luxmeter& meter : rig.luxmeters) names.emplace_back(meter.name);
  if (of == Names::fixtures)
    for (const Fixture& fixture : rig.fixtures) names.emplace_back(fixture.name);
  return names;
}

constexpr std::string_view kind_of_names(Names of) {
  return of == Names::points ? "point" : of == Names::luxmeters ? "luxmeter" : "fixture";
}

class ConditionReader {
 public:
  ConditionReader(std::string_view text, const FilePosition& in_file, const Rig& rig, ProblemList& problems)
      : text_(text), in_file_(in_file), rig_(rig), problems_(problems), words_(words_of(text)) {}

  std::optional<Condition> read() {
    Condition condition;
    condition.written = text_;
    std::vector<std::string_view> known;
    for (const Subject& subject : kSubjects) known.push_back(subject.name);
    if (words_.empty()) return wrong(0, "the condition is empty", "write one, as \"lux desk >= 300\"");
    const auto* subject = std::find_if(std::begin(kSubjects), std::end(kSubjects),
                                       [&](const Subject& s) { return s.name == words_[0].text; });
    if (subject == std::end(kSubjects))
      return wrong(0, fmt::format("unknown subject {}", in_quotes(words_[0].text)),
                   mend_for_unknown(words_[0].text, known, ""));
    condition.of = subject->of;
    next_ = 1;
    if (subject->names != Names::none && !read_names(*subject, condition)) return std::nullopt;
    if (subject->compared && !read_comparison(*subject, condition)) return std::nullopt;
    if (condition.of == Of::phase && !read_phase(condition)) return std::nullopt;
    if (condition.of == Of::alarm) {
      if (next_ == words_.size())
        return wrong(next_, "alarm without a text", "add some words of the alarm: alarm does not answer");
      // All that follows, spaces too.
      condition.text = words_.size() == 2 ? words_[1].text : std::string(text_.substr(words_[1].at));
      next_ = words_.size();
    }
    if (next_ < words_.size())
      return wrong(next_, fmt::format("{} is one word too many", in_quotes(words_[next_].text)),
                   "remove it; a name with spaces stands in single quotes");
    return condition;
  }

 private:
  std::nullopt_t wrong(std::size_t word, std::string what, std::string mend) {
    const std::size_t at = word < words_.size() ? words_[word].at : text_.size();
    FilePosition place = in_file_;
    place.column += static_cast<int>(at) + 1;  // past the quote
    problems_.add(place, std::move(what), std::move(mend));
    return std::nullopt;
  }

  bool read_names(const Subject& subject, Condition& condition) {
    const std::vector<std::string_view> known = names_in(rig_, subject.names);
    const std::string_view kind = kind_of_names(subject.names);
    if (next_ == words_.size()) {
      wrong(next_, fmt::format("{} needs the name of a {}", subject.name, kind),
            mend_for_unknown("", known, "name it"));
      return false;
    }
    const std::string& pattern = words_[next_].text;
    for (std::size_t i = 0; i < known.size(); ++i)
      if (known[i] == pattern || fnmatch(pattern.c_str(), std::string(known[i]).c_str(), 0) == 0)
        condition.which.push_back(i);
    if (condition.which.empty()) {
      wrong(next_, fmt::format("{} fits no {}", in_quotes(pattern), kind),
            mend_for_unknown(pattern, known, fmt::format("the rig has no {}", kind)));
      return false;
    }
    if (subject.of == Of::pan || subject.of == Of::tilt)
      for (const std::size_t f : condition.which)
        if (!rig_.fixtures[f].moves) {
          wrong(next_, fmt::format("fixture {} does not turn", in_quotes(rig_.fixtures[f].name)), "name a head");
          return false;
        }
    ++next_;
    return true;
  }

  bool read_comparison(const Subject& subject, Condition& condition) {
    const auto has = [&] { return next_ < words_.size(); };
    const auto* relation = has() ? std::find_if(std::begin(kRelations), std::end(kRelations),
                                                [&](const RelationName& r) { return r.name == words_[next_].text; })
                                 : std::end(kRelations);
    if (relation == std::end(kRelations)) {
      wrong(next_,
            has() ? fmt::format("{} is no comparison", in_quotes(words_[next_].text))
                  : fmt::format("{} is not compared with anything", subject.name),
            "write <, <=, >, >=, ==, != or between, with a space on each side");
      return false;
    }
    condition.relation = relation->relation;
    ++next_;
    const auto unit = [&] { next_ += has() && !subject.unit.empty() && words_[next_].text == subject.unit; };
    const auto word = [&](std::string_view wanted) {
      const bool there = has() && words_[next_].text == wanted;
      next_ += there;
      return there;
    };
    if (!read_number(relation->name, condition.value)) return false;
    unit();
    if (condition.relation == Relation::between) {
      if (!word("and")) {
        wrong(next_, "between has one number", "write two: between 45 and 50");
        return false;
      }
      const std::size_t at = next_;
      if (!read_number("and", condition.most)) return false;
      unit();
      if (condition.most < condition.value) {
        wrong(at, fmt::format("nothing lies between {:g} and {:g}", condition.value, condition.most),
              "write the lower number first");
        return false;
      }
    } else if (condition.relation == Relation::equal && (word("+-") || word("±"))) {
      const std::size_t at = next_;
      double tolerance = 0;
      if (!read_number("+-", tolerance)) return false;
      if (tolerance < 0) {
        wrong(at, fmt::format("a tolerance of {:g} is below 0", tolerance), "write how far off it may be");
        return false;
      }
      if (word("%"))
        tolerance *= std::abs(condition.value) / 100;
      else
        unit();
      condition.relation = Relation::between;
      condition.most = condition.value + tolerance;
      condition.value -= tolerance;
    }
    return true;
  }

  bool read_number(std::string_view after, double& value) {
    if (next_ == words_.size()) {
      wrong(next_, "the number is missing", fmt::format("add it after {}", after));
      return false;
    }
    const std::string& number = words_[next_].text;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value)) {
      wrong(next_, fmt::format("{} is not a number", in_quotes(number)), "write one, as 50 or 0.95");
      return false;
    }
    ++next_;
    return true;
  }

  bool read_phase(Condition& condition) {
    const std::vector<std::string_view> known = phase_names();
    const std::string given = next_ < words_.size() ? words_[next_].text : "";
    const auto at = std::find(known.begin(), known.end(), given);
    if (at == known.end()) {
      wrong(next_, given.empty() ? "phase without its name" : fmt::format("there is no phase {}", in_quotes(given)),
            mend_for_unknown(given, known, ""));
      return false;
    }
    condition.phase = static_cast<Phase>(at - known.begin());
    ++next_;
    return true;
  }

  std::string_view text_;
  FilePosition in_file_;
  const Rig& rig_;
  ProblemList& problems_;
  std::vector<Word> words_;
  std::size_t next_ = 0;
};

bool has_alarm(const ShowStatus& status, const std::string& text) {
  return std::any_of(status.alarms.begin(), status.alarms.end(), [&](const Alarm& alarm) {
    return (alarm.device + ": " + alarm.text).find(text) != std::string::npos;
  });
}

}  // namespace

std::optional<Condition> parse_condition(std::string_view text, const FilePosition& in_file, const Rig& rig,
                                         ProblemList& problems) {
  return ConditionReader(text, in_file, rig, problems).read();
}

double value_at(const Condition& c, std::size_t k, const Instant& instant) {
  const ShowStatus& status = *instant.status;
  switch (c.of) {
    case Of::lux:
      return instant.lux[c.which[k]];
    case Of::reading:
      return instant.reading_lx[c.which[k]].value_or(NAN);
    case Of::level:
      return instant.level[c.which[k]];
    case Of::pan:
      return deg_from_rad(instant.joints[c.which[k]].pan_rad);
    case Of::tilt:
      return deg_from_rad(instant.joints[c.which[k]].tilt_rad);
    case Of::lux_hours:
      return instant.lux_hours[c.which[k]];
    case Of::met:
      return status.goals.met;
    case Of::missed:
      return status.goals.missed;
    case Of::unknown:
      return status.goals.unknown;
    case Of::alarms:
      return static_cast<double>(
          std::count_if(status.alarms.begin(), status.alarms.end(), [](const Alarm& alarm) { return alarm.severe; }));
    case Of::phase:
      return status.phase == c.phase ? 1 : 0;
    case Of::alarm:
      return has_alarm(status, c.text) ? 1 : 0;
    case Of::blackout:
      return status.blackout ? 1 : 0;
    case Of::exit:
      return instant.exit ? static_cast<double>(*instant.exit) : NAN;
  }
  return NAN;
}

bool holds(const Condition& c, double value) {
  if (std::isnan(value)) return false;
  if (!subject_of(c.of).compared) return value != 0;
  switch (c.relation) {
    case Relation::less:
      return value < c.value;
    case Relation::at_most:
      return value <= c.value;
    case Relation::more:
      return value > c.value;
    case Relation::at_least:
      return value >= c.value;
    case Relation::equal:
      return value == c.value;
    case Relation::not_equal:
      return value != c.value;
    case Relation::between:
      return value >= c.value && value <= c.most;
  }
  return false;
}

std::optional<std::size_t> first_that(bool holding, const Condition& c, const Instant& instant) {
  const std::size_t count = std::max<std::size_t>(1, c.which.size());
  for (std::size_t k = 0; k < count; ++k)
    if (holds(c, value_at(c, k, instant)) == holding) return k;
  return std::nullopt;
}

bool holds_for_all(const Condition& c, const Instant& instant) { return !first_that(false, c, instant); }

std::string name_at(const Condition& c, std::size_t k, const Rig& rig) {
  const Names names = subject_of(c.of).names;
  return names == Names::none ? "" : std::string(names_in(rig, names)[c.which[k]]);
}

std::string value_text(const Condition& c, std::size_t k, const Instant& instant, const Rig& rig) {
  if (c.of == Of::phase) return fmt::format("phase is {}", luxrig::name_of(instant.status->phase));
  if (c.of == Of::blackout) return instant.status->blackout ? "there is a blackout" : "there is no blackout";
  const double value = value_at(c, k, instant);
  if (c.of == Of::alarm) return value != 0 ? "there is such an alarm" : "there is no such alarm";
  const Subject& subject = subject_of(c.of);
  const std::string name = name_at(c, k, rig);
  if (c.of == Of::exit && std::isnan(value)) return "no daemon has ended yet";
  if (std::isnan(value)) return fmt::format("{} of {} is not known yet", subject.name, name);
  return fmt::format("{}{}{} is {:.4g}{}{}", subject.name, name.empty() ? "" : " of ", name, value,
                     subject.unit.empty() ? "" : " ", subject.unit);
}

}  // namespace luxrig::scenario
