#include "tools/scenario/outcome_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/plain_text.h"

namespace luxrig::scenario {
namespace {

using nlohmann::json;

json to_json(const std::vector<Judged>& all) {
  json list = json::array();
  for (const Judged& one : all) {
    json entry = {{"expected", one.expected}, {"held", one.held}};
    if (one.line > 0) entry["line"] = one.line;
    if (one.at_s) entry["at_s"] = *one.at_s;
    if (!one.found.empty()) entry["found"] = one.found;
    if (!one.why.empty()) entry["why"] = one.why;
    list.push_back(std::move(entry));
  }
  return list;
}

std::vector<Judged> judged_of(const json& list) {
  std::vector<Judged> all;
  for (const json& entry : list) {
    Judged one;
    one.expected = entry["expected"];
    one.held = entry["held"];
    one.line = entry.value("line", 0);
    if (entry.contains("at_s")) one.at_s = entry["at_s"].get<double>();
    one.found = entry.value("found", "");
    one.why = entry.value("why", "");
    all.push_back(std::move(one));
  }
  return all;
}

std::string text(const json& value) { return value.dump(1, ' ', false, json::error_handler_t::replace) + "\n"; }

struct Picture {
  std::string title, unit;
  std::vector<std::size_t> columns;
};

/// A column's kind is its first word.
std::vector<Picture> pictures_of(const Trace& trace) {
  std::vector<Picture> pictures = {{"Light at the points", "lx", {}}, {"Luxmeters", "lx", {}}, {"Levels sent", "", {}}};
  for (std::size_t c = 0; c < trace.columns.size(); ++c) {
    const std::string& name = trace.columns[c];
    const int which = name.starts_with("lux ")       ? 0
                      : name.starts_with("reading ") ? 1
                      : name.starts_with("level ")   ? 2
                                                     : -1;
    if (which >= 0) pictures[static_cast<std::size_t>(which)].columns.push_back(c);
  }
  std::erase_if(pictures, [](const Picture& picture) { return picture.columns.empty(); });
  return pictures;
}

constexpr double kWidth = 900, kHeight = 240, kLeft = 60, kBottom = 24, kTop = 10;

std::string svg_of(const Picture& picture, const Outcome& outcome, double length_s) {
  const Trace& trace = outcome.trace;
  double most = 0;
  for (const auto& row : trace.rows)
    for (const std::size_t c : picture.columns)
      if (std::isfinite(row[c])) most = std::max(most, row[c]);
  if (!(most > 0)) most = 1;
  const auto x = [&](double at_s) { return kLeft + (kWidth - kLeft - 10) * at_s / std::max(length_s, 1e-9); };
  const auto y = [&](double value) { return kHeight - kBottom - (kHeight - kBottom - kTop) * value / most; };
  std::string svg = fmt::format("<h2>{}</h2>\n<svg viewBox=\"0 0 {:g} {:g}\" role=\"img\">\n", escaped_for_markup(picture.title),
                                kWidth, kHeight);
  for (int k = 0; k <= 4; ++k) {
    const double value = most * k / 4;
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.3g} {}</text>\n",
        kLeft, kWidth - 10, y(value), y(value), kLeft - 4, y(value) + 4, value, picture.unit);
    const double at_s = length_s * k / 4;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{:.4g} s</text>\n", x(at_s), kHeight - 6,
                       k == 4 ? "end" : "middle", at_s);
  }
  for (const std::vector<Judged>* all : {&outcome.expectations, &outcome.rules})
    for (const Judged& one : *all)
      if (!one.held && one.at_s)
        svg += fmt::format(
            "<line class=\"failed\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:g}\" y2=\"{2:.1f}\"><title>{3}"
            "</title></line>\n",
            x(*one.at_s), kTop, kHeight - kBottom, escaped_for_markup(one.expected + ": " + one.found));
  for (std::size_t k = 0; k < picture.columns.size(); ++k) {
    const std::size_t c = picture.columns[k];
    std::string points;
    for (std::size_t i = 0; i < trace.rows.size(); ++i)
      if (std::isfinite(trace.rows[i][c]))
        points += fmt::format("{:.1f},{:.1f} ", x(trace.at_s[i]), y(trace.rows[i][c]));
    svg += fmt::format("<polyline points=\"{}\" stroke=\"hsl({:.0f} 65% 42%)\"><title>{}</title></polyline>\n", points,
                       360.0 * static_cast<double>(k) / static_cast<double>(picture.columns.size()),
                       escaped_for_markup(trace.columns[c]));
  }
  return svg + "</svg>\n";
}

std::string failed_text(const Judged& one) {
  return fmt::format("{}{}{}{}", one.at_s ? fmt::format("at {:.2f} s: ", *one.at_s) : "", one.found,
                     one.why.empty() ? "" : "; ", one.why);
}

}  // namespace

json to_json(const Outcome& outcome) {
  json out = {{"seed", outcome.seed},
              {"passed", outcome.passed()},
              {"expectations", to_json(outcome.expectations)},
              {"rules", to_json(outcome.rules)},
              {"events", json::array()}};
  for (const Happened& event : outcome.events) out["events"].push_back({{"at_s", event.at_s}, {"what", event.text}});
  if (!outcome.error.empty()) out["error"] = outcome.error;
  if (!outcome.trace.columns.empty())
    out["trace"] = {{"columns", outcome.trace.columns}, {"at_s", outcome.trace.at_s}, {"rows", outcome.trace.rows}};
  return out;
}

Outcome outcome_of(const json& in) {
  Outcome outcome;
  outcome.seed = in["seed"];
  outcome.expectations = judged_of(in["expectations"]);
  outcome.rules = judged_of(in["rules"]);
  for (const json& event : in["events"]) outcome.events.push_back({event["at_s"], event["what"]});
  outcome.error = in.value("error", "");
  if (!in.contains("trace")) return outcome;
  const json& trace = in["trace"];
  outcome.trace.columns = trace["columns"].get<std::vector<std::string>>();
  outcome.trace.at_s = trace["at_s"].get<std::vector<double>>();
  for (const json& row : trace["rows"]) {
    std::vector<double> values;
    for (const json& value : row) values.push_back(value.is_null() ? NAN : value.get<double>());
    outcome.trace.rows.push_back(std::move(values));
  }
  return outcome;
}

std::string results_json(const std::string& rig, const std::vector<Tested>& tested) {
  json out = {{"rig", rig}, {"passed", true}, {"scenarios", json::array()}};
  for (const Tested& one : tested) {
    bool passed = true;
    json runs = json::array();
    for (const Outcome& outcome : one.outcomes) {
      passed = passed && outcome.passed();
      runs.push_back(scenario::to_json(outcome));
    }
    out["scenarios"].push_back(
        {{"file", one.scenario.file.string()}, {"name", one.scenario.name}, {"passed", passed}, {"runs", runs}});
    if (!passed) out["passed"] = false;
  }
  return text(out);
}

std::string junit_xml(const std::string& rig, const std::vector<Tested>& tested) {
  std::string suites;
  int all_cases = 0, all_failed = 0;
  for (const Tested& one : tested) {
    std::string cases;
    int count = 0, failed = 0;
    for (const Outcome& outcome : one.outcomes) {
      const auto add = [&](const std::string& name, bool held, const std::string& why) {
        ++count;
        cases += fmt::format("    <testcase classname=\"{}\" name=\"{}, seed {}\"",
                             escaped_for_markup(one.scenario.file.stem().string()), escaped_for_markup(name), outcome.seed);
        if (held) {
          cases += "/>\n";
          return;
        }
        ++failed;
        cases += fmt::format(">\n      <failure message=\"{}\"/>\n    </testcase>\n", escaped_for_markup(why));
      };
      if (!outcome.error.empty()) add("it runs", false, outcome.error);
      for (const std::vector<Judged>* list : {&outcome.expectations, &outcome.rules})
        for (const Judged& judged : *list) add(judged.expected, judged.held, failed_text(judged));
    }
    suites += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n{}  </testsuite>\n",
                          escaped_for_markup(one.scenario.name), count, failed, cases);
    all_cases += count;
    all_failed += failed;
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"{}\" tests=\"{}\" failures=\"{}\">\n{}"
      "</testsuites>\n",
      escaped_for_markup(rig), all_cases, all_failed, suites);
}

std::string trace_csv(const Trace& trace) {
  const auto field = [](const std::string& name) {
    std::string quoted = "\"";
    for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
  };
  std::string out = "at_s";
  for (const std::string& column : trace.columns) out += "," + field(column);
  out += "\n";
  for (std::size_t i = 0; i < trace.rows.size(); ++i) {
    out += fmt::format("{:.2f}", trace.at_s[i]);
    for (const double value : trace.rows[i]) out += std::isfinite(value) ? fmt::format(",{:.6g}", value) : ",";
    out += "\n";
  }
  return out;
}

std::string trace_html(const Scenario& scenario, const Outcome& outcome) {
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}, seed {1}</title>\n<style>\n"
      "body {{ font: 15px/1.45 system-ui, sans-serif; max-width: 60rem; margin: 1.5rem auto; padding: 0 1rem; }}\n"
      "h1 {{ font-size: 1.3rem; }} h2 {{ font-size: 1rem; margin: 1.4rem 0 0.2rem; }}\n"
      "svg {{ width: 100%; height: auto; }} svg text {{ font-size: 11px; fill: #444; }}\n"
      "polyline {{ fill: none; stroke-width: 1.3; }} polyline:hover {{ stroke-width: 3; }}\n"
      ".grid {{ stroke: #ddd; }} .failed {{ stroke: #c00; stroke-width: 2; stroke-dasharray: 5 3; }}\n"
      "td {{ padding: 0.1rem 0.9rem 0.1rem 0; vertical-align: top; }} .bad {{ color: #b00; }}\n"
      "</style></head><body>\n<h1>{0}, seed {1}</h1>\n",
      escaped_for_markup(scenario.name), outcome.seed);
  if (!outcome.error.empty()) out += fmt::format("<p class=\"bad\">{}</p>\n", escaped_for_markup(outcome.error));
  out += "<table>\n";
  for (const std::vector<Judged>* list : {&outcome.expectations, &outcome.rules})
    for (const Judged& one : *list)
      out += fmt::format("<tr{}><td>{}</td><td>{}</td><td>{}</td></tr>\n", one.held ? "" : " class=\"bad\"",
                         one.held ? "ok" : "failed", escaped_for_markup(one.expected), one.held ? "" : escaped_for_markup(failed_text(one)));
  out += "</table>\n";
  for (const Picture& picture : pictures_of(outcome.trace)) out += svg_of(picture, outcome, scenario.length_s);
  out += "<h2>What happened</h2>\n<table>\n";
  for (const Happened& event : outcome.events)
    out += fmt::format("<tr><td>{:.2f} s</td><td>{}</td></tr>\n", event.at_s, escaped_for_markup(event.text));
  return out + "</table>\n</body></html>\n";
}

}  // namespace luxrig::scenario
