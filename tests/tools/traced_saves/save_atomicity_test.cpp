// Every kill and every error at each system call of a save: a child that saves is traced, and call n is made to kill it
// or fail, for all n.
#include <elf.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "tests/tools/luxrigd/state/saved_state.h"
#include "tests/tools/programs/process.h"
#include "tools/luxrigd/state/journal.h"

#if (defined(__x86_64__) && defined(__LP64__)) || defined(__aarch64__)
namespace luxrig {
namespace {

using luxrig::testing::files_in;
using luxrig::testing::Folder;
using luxrig::testing::state_with;
using luxrig::testing::text_of;

/// Registers of a traced process stopped at a system call.
class CallRegisters {
 public:
  explicit CallRegisters(pid_t pid) : pid_(pid) {
    iovec room{&registers_, sizeof registers_};
    good_ = ::ptrace(PTRACE_GETREGSET, pid_, NT_PRSTATUS, &room) == 0;
  }
  [[nodiscard]] bool good() const { return good_; }
#if defined(__x86_64__)
  [[nodiscard]] long number() const { return static_cast<long>(registers_.orig_rax); }
  [[nodiscard]] std::uint64_t first() const { return registers_.rdi; }
  [[nodiscard]] std::uint64_t third() const { return registers_.rdx; }
  void set_third(std::uint64_t value) { registers_.rdx = value; }
  void set_result(long value) { registers_.rax = static_cast<unsigned long long>(value); }
  /// The kernel does nothing in its place.
  void skip() { registers_.orig_rax = ~0ULL; }
#else
  [[nodiscard]] long number() const { return static_cast<long>(registers_.regs[8]); }
  [[nodiscard]] std::uint64_t first() const { return registers_.regs[0]; }
  [[nodiscard]] std::uint64_t third() const { return registers_.regs[2]; }
  void set_third(std::uint64_t value) { registers_.regs[2] = value; }
  void set_result(long value) { registers_.regs[0] = static_cast<unsigned long long>(value); }
  void skip() {
    int none = -1;
    iovec room{&none, sizeof none};
    good_ = good_ && ::ptrace(PTRACE_SETREGSET, pid_, NT_ARM_SYSTEM_CALL, &room) == 0;
  }
#endif
  [[nodiscard]] bool put() {
    iovec room{&registers_, sizeof registers_};
    return good_ && ::ptrace(PTRACE_SETREGSET, pid_, NT_PRSTATUS, &room) == 0;
  }

 private:
  pid_t pid_;
  user_regs_struct registers_{};
  bool good_ = false;
};

enum class Harm { none, killed_before, killed_after, refused, cut_short };

struct Injection {
  Harm harm = Harm::none;
  std::size_t call = 0;
  int error = 0;  ///< errno, for refused
};

/// One observed system call of the save.
struct SeenCall {
  long number = 0;
  std::string file{};  ///< of fsync: the synced file
};

/// The child's results, in shared memory.
struct Said {
  bool saved = false;
  bool holds_new = false;  ///< Journal::state()
  bool unsaved = false;    ///< Journal::unsaved()
  bool saved_later = false;
};

enum class How { save_first, keep };

constexpr const char* kOld = "old plan";
constexpr const char* kNew = "new plan";
constexpr const char* kLater = "later plan";

bool is(const std::optional<JournalState>& state, const char* plan) {
  const JournalState wanted = state_with(plan);
  return state && state->plan_json == wanted.plan_json && state->parked == wanted.parked &&
         state->by_hand.size() == 1 && state->by_hand[0].name == plan;
}

/// Calls for memory and locks are not part of a save, and are never refused.
bool is_of_files(long number) {
  static const std::set<long> others = {
      SYS_brk,   SYS_mmap,         SYS_munmap,         SYS_mprotect,  SYS_mremap, SYS_madvise,
      SYS_futex, SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_getrandom, SYS_gettid, SYS_sched_yield};
  return !others.contains(number);
}

class TracedSave {
 public:
  /// Forks a child that calls `first`, stops for the parent to look, then calls `later`.
  template <class First, class Later>
  TracedSave(First first, Later later) {
    void* shared = ::mmap(nullptr, sizeof(Said), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) return;
    said_ = new (shared) Said;
    pid_ = ::fork();
    if (pid_ == 0) {
      const pid_t self = ::getpid();
      if (::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) ::_exit(77);
      ::kill(self, SIGSTOP);
      first(*said_);
      ::kill(self, SIGSTOP);
      later(*said_);
      ::_exit(0);
    }
  }
  ~TracedSave() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    if (said_ != nullptr) ::munmap(said_, sizeof(Said));
  }
  TracedSave(const TracedSave&) = delete;
  TracedSave& operator=(const TracedSave&) = delete;

  /// False if processes may not be traced here.
  [[nodiscard]] bool begin() {
    return waits() && WIFSTOPPED(status_) &&
           ::ptrace(PTRACE_SETOPTIONS, pid_, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL) == 0;
  }

  /// Runs the child to its stop or its end. False if an unexpected event occurs.
  [[nodiscard]] bool run(const Injection& injection) {
    while (true) {
      if (!to_next_stop()) return false;
      CallRegisters entry(pid_);
      if (!entry.good()) return false;
      SeenCall seen{entry.number()};
      if (seen.number == SYS_kill)  // it stops itself
        return to_next_stop() && (WSTOPSIG(status_) == SIGSTOP || (to_next_stop() && WSTOPSIG(status_) == SIGSTOP));
      if (seen.number == SYS_fsync) {
        std::error_code error;
        seen.file = std::filesystem::read_symlink(
            "/proc/" + std::to_string(pid_) + "/fd/" + std::to_string(entry.first()), error);
      }
      const bool chosen = calls_.size() == injection.call && injection.harm != Harm::none;
      calls_.push_back(seen);
      if (chosen && injection.harm == Harm::killed_before) return end();
      const auto third = entry.third();
      bool harmed = false;
      if (chosen && injection.harm == Harm::refused && is_of_files(seen.number)) {
        entry.skip();
        if (!entry.put()) return false;
        harmed = true;
      } else if (chosen && injection.harm == Harm::cut_short && seen.number == SYS_write) {
        entry.set_third(third / 2);
        if (!entry.put()) return false;
        harmed = true;
      }
      if (!to_next_stop()) return false;
      if (chosen && injection.harm == Harm::killed_after) return end();
      if (!harmed) continue;
      harmed_ = true;
      CallRegisters exit(pid_);
      if (injection.harm == Harm::refused)
        exit.set_result(-injection.error);
      else
        exit.set_third(third);  // a system call leaves its arguments as they were
      if (!exit.put()) return false;
    }
  }
  /// Runs the rest untraced. False unless it ends well.
  [[nodiscard]] bool finish() {
    if (::ptrace(PTRACE_DETACH, pid_, nullptr, nullptr) != 0 || !waits()) return false;
    pid_ = -1;
    return WIFEXITED(status_) && WEXITSTATUS(status_) == 0;
  }

  [[nodiscard]] const std::vector<SeenCall>& calls() const { return calls_; }
  [[nodiscard]] const Said& said() const { return *said_; }
  [[nodiscard]] bool harmed() const { return harmed_; }
  [[nodiscard]] bool alive() const { return pid_ > 0; }

 private:
  bool waits() { return pid_ > 0 && ::waitpid(pid_, &status_, 0) == pid_; }
  bool to_next_stop() {
    return ::ptrace(PTRACE_SYSCALL, pid_, nullptr, nullptr) == 0 && waits() && WIFSTOPPED(status_);
  }
  bool end() {
    ::kill(pid_, SIGKILL);
    const bool ended = waits();
    pid_ = -1;
    harmed_ = true;
    return ended;
  }

  pid_t pid_ = -1;
  int status_ = 0;
  Said* said_ = nullptr;
  std::vector<SeenCall> calls_;
  bool harmed_ = false;
};

struct Outcome {
  bool traced = false;
  std::vector<SeenCall> calls;
};

/// One save of kNew with one injected fault, over kOld or into an empty folder.
Outcome save_with(How how, bool over_old, const Injection& injection) {
  const Folder folder;
  const auto place = folder / "made/state";
  Journal journal(place);
  if (over_old) {
    EXPECT_TRUE(journal.save_first([](JournalState& state) { state = state_with(kOld); }));
  }
  const auto save = [&journal](How by, const char* plan) {
    const auto change = [plan](JournalState& state) { state = state_with(plan); };
    return (by == How::keep ? journal.keep(change) : journal.save_first(change)).has_value();
  };
  TracedSave child(
      [&](Said& said) {
        said.saved = save(how, kNew);
        said.holds_new = is(journal.state(), kNew);
        said.unsaved = journal.unsaved().has_value();
      },
      [&](Said& said) { said.saved_later = save(How::save_first, kLater); });
  Outcome outcome;
  outcome.traced = child.begin();
  if (!outcome.traced) return outcome;
  EXPECT_TRUE(child.run(injection));
  outcome.calls = child.calls();
  const Said& said = child.said();

  const auto left = Journal(place).load();
  for (const std::string& complaint : left.complaints) ADD_FAILURE() << complaint;
  const bool is_new = is(left.state, kNew);
  EXPECT_TRUE(is_new || (over_old ? is(left.state, kOld) : !left.state || left.state->plan_json.empty()))
      << "neither wholly old nor wholly new";
  if (left.state) {
    EXPECT_FALSE(nlohmann::json::parse(text_of(place / "state.json"), nullptr, false).is_discarded());
  }
  std::set<std::string> names = files_in(place);
  names.erase("state.json");
  names.erase("state.json.new");
  EXPECT_TRUE(names.empty()) << *names.begin();

  if (!child.alive()) {  // killed: another daemon goes on from there
    Journal next(place);
    EXPECT_TRUE(next.save_first([](JournalState& state) { state = state_with(kLater); }));
  } else {
    if (said.saved) {
      EXPECT_TRUE(is_new) << "it said that it had saved";
      EXPECT_TRUE(said.holds_new);
      EXPECT_FALSE(said.unsaved);
    } else {
      EXPECT_NE(injection.harm, Harm::none);
      EXPECT_NE(injection.harm, Harm::cut_short);
      EXPECT_EQ(said.holds_new, how == How::keep);
      EXPECT_EQ(said.unsaved, how == How::keep);
      EXPECT_FALSE(how == How::save_first && is_new) << "what was refused would come back with the next start";
      EXPECT_FALSE(std::filesystem::exists(place / "state.json.new")) << "it keeps a full disk full";
    }
    if (child.harmed() && injection.error == EINTR) {
      const long number = child.calls()[injection.call].number;
      EXPECT_TRUE(said.saved || (number != SYS_openat && number != SYS_write && number != SYS_fsync))
          << "a signal is no error";
    }
    EXPECT_TRUE(child.finish());
    EXPECT_TRUE(said.saved_later);
  }
  EXPECT_TRUE(is(Journal(place).load().state, kLater));
  EXPECT_EQ(files_in(place), std::set<std::string>{"state.json"});
  return outcome;
}

/// Name for messages.
std::string name_of(const Injection& injection, const std::vector<SeenCall>& calls) {
  static const std::map<Harm, const char*> words = {{Harm::none, "nothing"},
                                                    {Harm::killed_before, "killed before"},
                                                    {Harm::killed_after, "killed after"},
                                                    {Harm::refused, "refused"},
                                                    {Harm::cut_short, "cut short"}};
  return std::string(words.at(injection.harm)) + " at call " + std::to_string(injection.call) + " (system call " +
         std::to_string(calls[injection.call].number) + " " + calls[injection.call].file + ")" +
         (injection.error != 0 ? std::string(": ") + std::strerror(injection.error) : "");
}

class SaveAtomicity : public ::testing::TestWithParam<std::tuple<How, bool>> {};

TEST_P(SaveAtomicity, HoldsForAnyFailureOfAnySystemCall) {
  const auto [how, over_old] = GetParam();
  const Outcome whole = save_with(how, over_old, {});
  if (!whole.traced) GTEST_SKIP() << "processes may not be traced here";
  const auto is_call = [](long number) { return [number](const SeenCall& call) { return call.number == number; }; };
  ASSERT_TRUE(std::any_of(whole.calls.begin(), whole.calls.end(), is_call(SYS_write)));
  ASSERT_TRUE(std::any_of(whole.calls.begin(), whole.calls.end(), is_call(SYS_fsync)));
  std::vector<Injection> injections;
  for (std::size_t call = 0; call < whole.calls.size(); ++call) {
    injections.push_back({Harm::killed_before, call});
    injections.push_back({Harm::killed_after, call});
    if (whole.calls[call].number == SYS_write) injections.push_back({Harm::cut_short, call});
    if (!is_of_files(whole.calls[call].number)) continue;
    for (const int error : {ENOSPC, EIO, EACCES, EINTR}) injections.push_back({Harm::refused, call, error});
  }
  for (const Injection& injection : injections) {
    SCOPED_TRACE(name_of(injection, whole.calls));
    (void)save_with(how, over_old, injection);
  }
}

// A kill does not lose data that the kernel has not written yet; a power cut does.
TEST_P(SaveAtomicity, SyncsInTheRightOrderForAPowerCut) {
  const auto [how, over_old] = GetParam();
  const Outcome whole = save_with(how, over_old, {});
  if (!whole.traced) GTEST_SKIP() << "processes may not be traced here";
  std::vector<std::string> order;
  for (const SeenCall& call : whole.calls) {
    if (call.number == SYS_fsync) order.push_back(std::filesystem::path(call.file).filename());
#ifdef SYS_rename
    if (call.number == SYS_rename) order.push_back("renamed");
#endif
    if (call.number == SYS_renameat || call.number == SYS_renameat2) order.push_back("renamed");
  }
  std::vector<std::string> wanted = {"state.json.new", "renamed", "state"};
  if (!over_old) {
    ASSERT_GT(order.size(), 2u);
    EXPECT_EQ(order[0].rfind("luxrig-test-", 0), 0u) << "a new folder is in the folder above it: " << order[0];
    order.erase(order.begin());
    wanted.insert(wanted.begin(), "made");
  }
  EXPECT_EQ(order, wanted);
}

INSTANTIATE_TEST_SUITE_P(Journal, SaveAtomicity,
                         ::testing::Combine(::testing::Values(How::save_first, How::keep), ::testing::Bool()),
                         [](const auto& its) {
                           return std::string(std::get<0>(its.param) == How::keep ? "Keep" : "SaveFirst") +
                                  (std::get<1>(its.param) ? "OverOld" : "TheFirst");
                         });

// A start that was killed between moving a damaged file aside and saving its legible part used to lose a blackout.
TEST(SaveAtomicityOfAStart, ABlackoutSurvivesAnyFailureWhileReadingADamagedState) {
  constexpr const char* kDamaged = "{\n \"blackout\": true,\n \"by_hand\": [], \"pla";
  const auto start_with = [&](const Injection& injection) {
    const Folder folder;
    std::ofstream(folder / "state.json") << kDamaged;
    Journal journal(folder / "");
    TracedSave child(
        [&](Said& said) {
          const auto left = journal.load();
          said.saved = left.state && left.state->blackout;
          said.unsaved = !left.complaints.empty();
        },
        [](Said&) {});
    Outcome outcome;
    outcome.traced = child.begin();
    if (!outcome.traced) return outcome;
    EXPECT_TRUE(child.run(injection));
    outcome.calls = child.calls();
    EXPECT_EQ(text_of(folder / "state.json"), kDamaged);
    const auto left = journal.load();
    EXPECT_TRUE(left.state && left.state->blackout);
    EXPECT_EQ(text_of(folder / "state.json.damaged"), kDamaged);
    if (!child.alive()) return outcome;
    EXPECT_TRUE(child.said().unsaved) << "no complaint";
    EXPECT_TRUE(child.said().saved || injection.harm != Harm::none);
    EXPECT_TRUE(child.finish());
    return outcome;
  };
  const Outcome whole = start_with({});
  if (!whole.traced) GTEST_SKIP() << "processes may not be traced here";
  for (std::size_t call = 0; call < whole.calls.size(); ++call) {
    for (const Injection& injection : {Injection{Harm::killed_before, call}, Injection{Harm::killed_after, call},
                                       Injection{Harm::refused, call, EIO}, Injection{Harm::refused, call, EACCES}}) {
      SCOPED_TRACE(name_of(injection, whole.calls));
      (void)start_with(injection);
    }
  }
}

}  // namespace
}  // namespace luxrig
#endif
