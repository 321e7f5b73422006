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

LastLook look_of(std::size_t fixtures, double level) {
  LastLook look;
  look.sends = true;
  look.hold_s = 5;
  look.fade_s = 3;
  look.present.assign(fixtures, level);
  look.safe.assign(fixtures, level / 2);
  look.joints.assign(fixtures, {level, -level});
  look.silent.assign(fixtures, level > 0.5 ? 1 : 0);
  return look;
}

TEST(LastLook, IsReadAsItWasPut) {
  auto memory = LastLookMemory::create(7);
  ASSERT_TRUE(memory);
  EXPECT_FALSE(memory->take().sends);
  for (const double level : {0.25, 0.75, 0.5}) {
    memory->put(look_of(7, level));
    const LastLook look = memory->take();
    EXPECT_TRUE(look.sends);
    EXPECT_EQ(look.hold_s, 5);
    EXPECT_EQ(look.fade_s, 3);
    EXPECT_EQ(look.present, std::vector<double>(7, level));
    EXPECT_EQ(look.safe, std::vector<double>(7, level / 2));
    EXPECT_EQ(look.joints[6].tilt_rad, -level);
    EXPECT_EQ(look.silent[0], level > 0.5);
  }
  EXPECT_FALSE(memory->ended());
  memory->end();
  EXPECT_TRUE(memory->ended());
}

TEST(LastLook, CountsWhoLivesAndWhoHasTheLight) {
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

TEST(LastLook, OfAWriterGoneWrongIsStillWithinBounds) {
  auto memory = LastLookMemory::create(2);
  ASSERT_TRUE(memory);
  LastLook look = look_of(2, 0.5);
  look.present = {std::nan(""), 7};
  look.safe = {-1, std::numeric_limits<double>::infinity()};
  look.hold_s = std::nan("");
  look.fade_s = 1e300;
  look.joints[0].pan_rad = std::nan("");
  memory->put(look);
  const LastLook read = memory->take();
  EXPECT_EQ(read.present, (std::vector<double>{0, 1}));
  EXPECT_EQ(read.safe, (std::vector<double>{0, 0}));
  EXPECT_EQ(read.hold_s, 0);
  EXPECT_EQ(read.fade_s, 1e6);
  EXPECT_EQ(read.joints[0].pan_rad, 0);
}

TEST(LastLook, IsWholeHoweverItsWriterDies) {
  auto memory = LastLookMemory::create(500);
  ASSERT_TRUE(memory);
  for (int round = 0; round < 20; ++round) {
    const pid_t writer = ::fork();
    if (writer == 0) {
      for (int i = 0;; ++i) memory->put(look_of(500, (i % 100) / 100.0));
    }
    ::usleep(2000 + 531 * static_cast<useconds_t>(round));
    ::kill(writer, SIGKILL);
    ::waitpid(writer, nullptr, 0);
    const LastLook look = memory->take();
    if (!look.sends) continue;
    for (std::size_t f = 0; f < 500; ++f) {
      ASSERT_EQ(look.present[f], look.present[0]);
      ASSERT_EQ(look.safe[f], look.present[0] / 2);
      ASSERT_EQ(look.joints[f].tilt_rad, -look.present[0]);
    }
  }
  EXPECT_TRUE(memory->take().sends);
}

TEST(GuardianWords, SayWhereABusIs) {
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
