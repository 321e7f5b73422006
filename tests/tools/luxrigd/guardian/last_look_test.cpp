#include "tools/luxrigd/guardian/last_look.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "tools/luxrigd/guardian/guardian_words.h"

namespace luxrig {
namespace {

LightInForce light_at_level(std::size_t fixtures, double level) {
  LightInForce light;
  light.hold_s = 5;
  light.fade_s = 3;
  light.look.levels.assign(fixtures, level);
  light.safe_levels.assign(fixtures, level / 2);
  light.look.joints.assign(fixtures, {level, -level});
  light.silent.assign(fixtures, level > 0.5 ? 1 : 0);
  return light;
}

TEST(LastLook, ReadsTheNewestLight) {
  auto memory = LastLookMemory::create(7);
  ASSERT_TRUE(memory);
  EXPECT_FALSE(memory->take());
  for (const double level : {0.25, 0.75, 0.5}) {
    memory->put(light_at_level(7, level), true);
    const auto light = memory->take();
    ASSERT_TRUE(light);
    EXPECT_EQ(light->hold_s, 5);
    EXPECT_EQ(light->fade_s, 3);
    EXPECT_EQ(light->look.levels, std::vector<double>(7, level));
    EXPECT_EQ(light->safe_levels, std::vector<double>(7, level / 2));
    EXPECT_EQ(light->look.joints[6].tilt_rad, -level);
    EXPECT_EQ(light->silent[0], level > 0.5);
  }
  memory->put(light_at_level(7, 0.5), false);
  EXPECT_FALSE(memory->take()) << "nothing goes out";
  EXPECT_FALSE(memory->ended());
  memory->end();
  EXPECT_TRUE(memory->ended());
}

TEST(LastLook, TracksHeartbeatsAndTheHolderOfTheLight) {
  auto memory = LastLookMemory::create(2);
  ASSERT_TRUE(memory);
  auto other = LastLookMemory::open(::dup(memory->fd()), 2);
  ASSERT_TRUE(other);
  using Beat = LastLookMemory::Beat;
  for (const Beat whose : {Beat::output, Beat::control, Beat::guardian}) {
    const auto before = other->beats(whose);
    memory->beat(whose);
    EXPECT_EQ(other->beats(whose), before + 1);
  }
  EXPECT_FALSE(memory->guardian_has_the_light());
  other->take_the_light();
  EXPECT_TRUE(memory->guardian_has_the_light());
  memory->take_the_light_back();
  EXPECT_FALSE(other->guardian_has_the_light());
}

TEST(LastLook, OfAnotherRigIsRefused) {
  const auto memory = LastLookMemory::create(7);
  ASSERT_TRUE(memory);
  EXPECT_TRUE(LastLookMemory::open(::dup(memory->fd()), 7));
  EXPECT_FALSE(LastLookMemory::open(::dup(memory->fd()), 8));
  EXPECT_FALSE(LastLookMemory::open(-1, 7));
  const int null = ::open("/dev/null", O_RDWR);
  EXPECT_FALSE(LastLookMemory::open(null, 7));
  ::close(null);
}

TEST(LastLook, OfAFaultyWriterStaysWithinBounds) {
  auto memory = LastLookMemory::create(2);
  ASSERT_TRUE(memory);
  LightInForce light = light_at_level(2, 0.5);
  light.look.levels = {std::nan(""), 7};
  light.safe_levels = {-1, std::numeric_limits<double>::infinity()};
  light.hold_s = std::nan("");
  light.fade_s = 1e300;
  light.look.joints[0].pan_rad = std::nan("");
  memory->put(light, true);
  const auto read = memory->take();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->look.levels, (std::vector<double>{0, 1}));
  EXPECT_EQ(read->safe_levels, (std::vector<double>{0, 0}));
  EXPECT_EQ(read->hold_s, 0);
  EXPECT_EQ(read->fade_s, 1e6);
  EXPECT_EQ(read->look.joints[0].pan_rad, 0);
}

TEST(LastLook, IsWholeWheneverItsWriterDies) {
  auto memory = LastLookMemory::create(500);
  ASSERT_TRUE(memory);
  for (int round = 0; round < 20; ++round) {
    const pid_t writer = ::fork();
    if (writer == 0) {
      for (int i = 0;; ++i) {
        memory->put(light_at_level(500, (i % 100) / 100.0), true);
        memory->beat(LastLookMemory::Beat::output);
      }
    }
    // Wait until it has begun: on a busy machine, starting a process may take longer than all the pauses here.
    const std::uint32_t beats = memory->beats(LastLookMemory::Beat::output);
    for (int waited = 0; memory->beats(LastLookMemory::Beat::output) == beats && waited < 30'000; ++waited)
      ::usleep(1000);
    ::usleep(2000 + 531 * static_cast<useconds_t>(round));
    ::kill(writer, SIGKILL);
    ::waitpid(writer, nullptr, 0);
    const auto light = memory->take();
    if (!light) continue;
    const std::vector<double>& levels = light->look.levels;
    for (std::size_t f = 0; f < 500; ++f) {
      ASSERT_EQ(levels[f], levels[0]);
      ASSERT_EQ(light->safe_levels[f], levels[0] / 2);
      ASSERT_EQ(light->look.joints[f].tilt_rad, -levels[0]);
    }
  }
  EXPECT_TRUE(memory->take());
}

TEST(GuardianWords, RoundTripABusAddress) {
  for (const Redirect& to : {Redirect{"127.0.0.1", 5568, {}}, Redirect{"", 0, "/dev/pts/4"}}) {
    const auto read = redirect_of(redirect_text("a=b:c", to));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->first, "a=b:c");
    EXPECT_EQ(read->second.host, to.host);
    EXPECT_EQ(read->second.port, to.port);
    EXPECT_EQ(read->second.path, to.path);
  }
  for (const char* text :
       {"", "=", "dmx", "dmx=", "dmx=127.0.0.1", "dmx=127.0.0.1:", "dmx=h:0", "dmx=h:65536", "dmx=h:5x"})
    EXPECT_FALSE(redirect_of(text)) << text;
}

}  // namespace
}  // namespace luxrig
