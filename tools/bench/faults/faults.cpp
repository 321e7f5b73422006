#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/faults/fault_cases.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

std::string name_of_faults(const std::string& bus, const FaultPlan& plan) {
  return fmt::format("{}-{}{}", bus, sim::name_of(plan.kind), plan.suffix);
}

std::string median_and_worst(std::vector<double> values, const char* format = "{:.2f} / {:.2f}") {
  if (values.empty()) return "";
  std::sort(values.begin(), values.end());
  return fmt::format(fmt::runtime(format), values[values.size() / 2], values.back());
}

}  // namespace

bool fault_wanted(const BenchOptions& options, const std::string& bus, const FaultPlan& plan) {
  return name_of_faults(bus, plan).starts_with(options.only);
}

int fault_count(const BenchOptions& options) { return options.seeds.value_or(options.quick ? 10 : 100); }

BenchRow row_of_faults(const std::string& bus, const FaultPlan& plan, const std::string& unit,
                       const std::vector<FaultOutcome>& outcomes, double bound_s) {
  std::vector<double> departures, departed, excesses, reported, recovered;
  std::size_t bad = 0;
  std::string why;
  for (const FaultOutcome& outcome : outcomes) {
    departures.push_back(outcome.departure);
    departed.push_back(outcome.departed_s);
    excesses.push_back(outcome.excess);
    if (outcome.reported_s) reported.push_back(*outcome.reported_s);
    if (outcome.recovered_s) recovered.push_back(*outcome.recovered_s);
    if (outcome.astray.empty() && outcome.recovered_s) continue;
    ++bad;
    if (why.empty()) why = outcome.astray.empty() ? "not recovered" : outcome.astray;
  }
  BenchRow row;
  row.case_name = name_of_faults(bus, plan);
  row.method = bus;
  row.error = outcomes.empty() ? 1 : static_cast<double>(bad) / static_cast<double>(outcomes.size());
  row.target_error = 0;
  row.seconds = recovered.empty() ? std::nan("") : *std::max_element(recovered.begin(), recovered.end());
  row.target_seconds = bound_s;
  row.further = {
      {"cases", fmt::format("{}", outcomes.size())},
      {"unit", unit},
      {"departure", median_and_worst(departures, "{:.3f} / {:.3f}")},
      {"departed_s", median_and_worst(departed)},
      {"excess", median_and_worst(excesses, "{:.3f} / {:.3f}")},
      {"reported", fmt::format("{}", reported.size())},
      {"reported_s", median_and_worst(reported)},
      {"recovered_s", median_and_worst(recovered)},
      {"unasked", fmt::format("{}", bad)},
      {"note", why.empty() ? plan.note : why},
  };
  return row;
}

std::vector<BenchRow> bench_faults(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  add_level_faults(options, rows);
  add_axis_faults(options, rows);
  return rows;
}

}  // namespace luxrig
