#include "tools/bench/buses/bus_load.h"

#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <fstream>

namespace luxrig {
namespace {

double cpu_s(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

IntervalJitter jitter_of(const TimeCounts& deviations) {
  return {deviations.quantile(0.5), deviations.quantile(0.99), deviations.quantile(0.999), deviations.largest()};
}

void add_columns(BenchRow& row, const BusLoad& load) {
  const auto us = [&](double IntervalJitter::*which) {
    return load.jitter ? fmt::format("{:.0f}", 1e6 * ((*load.jitter).*which)) : std::string();
  };
  row.further = {
      {"core_share", load.core_share ? fmt::format("{:.4f}", *load.core_share) : ""},
      {"p50_us", us(&IntervalJitter::p50_s)},
      {"p99_us", us(&IntervalJitter::p99_s)},
      {"p999_us", us(&IntervalJitter::p999_s)},
      {"worst_us", us(&IntervalJitter::worst_s)},
      {"lost", load.lost ? fmt::format("{}", *load.lost) : ""},
      {"growth_kib", load.growth_bytes ? fmt::format("{}", *load.growth_bytes / 1024) : ""},
      {"note", load.note},
  };
}

std::int64_t resident_bytes() {
  std::ifstream in("/proc/self/statm");
  std::int64_t size = 0, resident = 0;
  in >> size >> resident;
  return resident * ::sysconf(_SC_PAGESIZE);
}

double process_cpu_s() { return cpu_s(CLOCK_PROCESS_CPUTIME_ID); }
double thread_cpu_s() { return cpu_s(CLOCK_THREAD_CPUTIME_ID); }

}  // namespace luxrig
