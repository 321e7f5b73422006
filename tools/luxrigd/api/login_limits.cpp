#include "tools/luxrigd/api/login_limits.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace luxrig {
namespace {

using std::chrono::seconds;

constexpr std::size_t kMaxCounts = 1024;
constexpr seconds kForgotten{3600};

}  // namespace

seconds LoginLimits::wait_of(const Count& count, const Rule& rule) {
  if (count.wrong < rule.free) return seconds(0);
  return std::min(rule.most, seconds(1) * (1 << std::min(count.wrong - rule.free, 20)));
}

LoginLimits::Count& LoginLimits::count_of(std::deque<Count>& counts, const std::string& of, Clock::time_point now) {
  const auto found = std::find_if(counts.begin(), counts.end(), [&](const Count& one) { return one.of == of; });
  Count count{of, 0, now};
  if (found != counts.end()) {
    if (now - found->last < kForgotten) count = *found;
    counts.erase(found);
  } else if (counts.size() >= kMaxCounts) {
    counts.pop_front();
  }
  counts.push_back(count);
  return counts.back();
}

int LoginLimits::attempt(const std::string& account, const std::string& from, Clock::time_point now) {
  // An account waits for a minute at most: whoever tries passwords from many addresses must not lock its owner out.
  constexpr Rule kOfAccount{10, seconds(60)}, kOfAddress{5, seconds(900)};
  const auto left_s = [&](const Count& count, const Rule& rule) {
    return static_cast<int>(std::chrono::ceil<seconds>(count.last + wait_of(count, rule) - now).count());
  };
  Count& of_address = count_of(addresses_, address_for_limits(from), now);
  if (const int wait_s = left_s(of_address, kOfAddress); wait_s > 0) return wait_s;
  // After the address: one that waits must not push the accounts' counts out with made-up names.
  Count& of_account = count_of(accounts_, account, now);
  if (const int wait_s = left_s(of_account, kOfAccount); wait_s > 0) return wait_s;
  for (Count* count : {&of_account, &of_address}) {
    ++count->wrong;
    count->last = now;
  }
  return 0;
}

void LoginLimits::right(const std::string& account, const std::string& from) {
  std::erase_if(accounts_, [&](const Count& one) { return one.of == account; });
  // Not forgotten: whoever has an account could go on trying others' after each login of their own.
  for (Count& one : addresses_)
    if (one.of == address_for_limits(from)) one.wrong = std::max(0, one.wrong - 1);
}

std::string address_for_limits(const std::string& from) {
  std::array<unsigned char, 16> bytes{};
  if (::inet_pton(AF_INET6, from.c_str(), bytes.data()) != 1) return from;
  std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
  std::array<char, INET6_ADDRSTRLEN> text{};
  return ::inet_ntop(AF_INET6, bytes.data(), text.data(), text.size()) ? text.data() : from;
}

}  // namespace luxrig
