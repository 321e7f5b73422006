#include "tools/luxrigd/api/access.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

using namespace std::chrono_literals;

HttpRequest with(const std::string& name, const std::string& value) {
  HttpRequest request;
  request.headers = {{name, value}};
  return request;
}

/// The cookie that a browser returns.
std::string returned(const std::string& set_cookie) { return set_cookie.substr(0, set_cookie.find(';')); }

constexpr int kLook = static_cast<int>(Role::look), kOperate = static_cast<int>(Role::operate),
              kConfigure = static_cast<int>(Role::configure);
constexpr std::int64_t kNoon = 1'800'000'000;

TEST(Access, AcceptsOnlyItsToken) {
  Access access, other;
  EXPECT_EQ(access.token().size(), 64u);
  EXPECT_NE(access.token(), other.token());
  EXPECT_EQ(access.sender(with("authorization", "Bearer " + access.token())).rank, kConfigure);
  for (const std::string& wrong : {std::string(), std::string("Bearer "), "Bearer " + other.token(), access.token(),
                                   "bearer" + access.token(), "Bearer " + access.token() + "0"})
    EXPECT_EQ(access.sender(with("authorization", wrong)).rank, 0) << wrong;
  EXPECT_EQ(access.sender({}).rank, 0);
  EXPECT_EQ(access.sender(with("cookie", "luxrig_session=" + access.token())).rank, 0);
}

TEST(Access, ACodeOpensOneBrowserOnceAndWithinTenMinutes) {
  Access access;
  access.set_port(9620);
  const auto start = Access::Clock::now();
  const std::string code = access.one_time_code(start);
  EXPECT_FALSE(access.open("", start));
  EXPECT_FALSE(access.open(std::string(64, '0'), start));
  const auto session = access.open(code, start + 599s);
  ASSERT_TRUE(session);
  EXPECT_FALSE(access.open(code, start + 599s)) << "used";
  EXPECT_FALSE(access.open(access.one_time_code(start), start + 600s)) << "too old";

  const std::string cookie = access.cookie(*session, false);
  EXPECT_NE(cookie.find("HttpOnly; SameSite=Strict; Path=/"), std::string::npos) << cookie;
  EXPECT_EQ(access.sender(with("cookie", returned(cookie))).credential, *session);
  EXPECT_EQ(access.sender(with("cookie", "a=b; " + returned(cookie) + "; c=d")).credential, *session);
  EXPECT_EQ(access.sender(with("cookie", "luxrig_session_9621=" + *session)).credential, "") << "another daemon's";
  EXPECT_EQ(access.sender(with("cookie", "luxrig_session_9620=")).credential, "");
}

TEST(Access, RemembersALimitedNumberOfBrowsers) {
  Access access;
  std::string first, last;
  for (int i = 0; i < 65; ++i) {
    last = *access.open(access.one_time_code());
    if (i == 0) first = last;
  }
  EXPECT_EQ(access.sender(with("cookie", returned(access.cookie(first, false)))).credential, "");
  EXPECT_EQ(access.sender(with("cookie", returned(access.cookie(last, false)))).credential, last);
  const std::string oldest = access.one_time_code();
  for (int i = 0; i < 64; ++i) (void)access.one_time_code();
  EXPECT_FALSE(access.open(oldest));
}

std::shared_ptr<const Accounts> anna_and_otto(Role of_anna = Role::operate,
                                              const std::string& password = "correct horse") {
  return std::make_shared<const Accounts>(
      Accounts{{{"anna", of_anna, *password_hash(password)}, {"otto", Role::look, *password_hash("battery staple")}},
               {{"ci", Role::look, token_hash("script's"), "2027-01-31"}}});
}

HttpRequest as(const Access& access, const std::string& session) {
  return with("cookie", returned(access.cookie(session, false)));
}

TEST(Access, APersonLogsInWithTheirRoleAndOutAgain) {
  Access access;
  const auto now = Access::Clock::now();
  EXPECT_EQ(access.log_in("anna", "correct horse", "10.0.0.7", now).session, "") << "there are no accounts";
  access.use(anna_and_otto());
  EXPECT_EQ(access.log_in("anna", "battery staple", "10.0.0.7", now).session, "") << "otto's password";
  EXPECT_EQ(access.log_in("nobody", "correct horse", "10.0.0.7", now).session, "");
  const auto in = access.log_in("anna", "correct horse", "10.0.0.7", now);
  ASSERT_EQ(in.session.size(), 64u);
  EXPECT_EQ(in.role, Role::operate);
  const HttpSender anna = access.sender(as(access, in.session), now);
  EXPECT_EQ(anna.name, "anna");
  EXPECT_EQ(anna.rank, kOperate);
  EXPECT_TRUE(access.still(anna, now));
  const auto other = access.log_in("otto", "battery staple", "10.0.0.7", now);
  EXPECT_EQ(access.sender(as(access, other.session), now).rank, kLook);
  access.log_out(anna);
  EXPECT_EQ(access.sender(as(access, in.session), now).rank, 0);
  EXPECT_FALSE(access.still(anna, now));
  EXPECT_EQ(access.sender(as(access, other.session), now).rank, kLook) << "another's session goes on";
}

TEST(Access, ASessionEndsAfterEightHoursWithoutARequestAndAnOpenPageIsNone) {
  Access access;
  access.use(anna_and_otto());
  const auto now = Access::Clock::now();
  const std::string session = access.log_in("anna", "correct horse", "10.0.0.7", now).session;
  const HttpSender anna = access.sender(as(access, session), now + 7h);
  EXPECT_EQ(anna.rank, kOperate);
  EXPECT_TRUE(access.still(anna, now + 14h)) << "a request after 7 h kept it alive";
  EXPECT_FALSE(access.still(anna, now + 15h)) << "asking whether it lives does not";
  EXPECT_EQ(access.sender(as(access, session), now + 15h).rank, 0);
}

TEST(Access, ASessionEndsWhenItsAccountChangesAndNotWhenAnothersDoes) {
  Access access;
  const auto first = anna_and_otto();
  access.use(first);
  const std::string anna = access.log_in("anna", "correct horse", "10.0.0.7").session;
  const std::string otto = access.log_in("otto", "battery staple", "10.0.0.7").session;
  for (const auto& [change, what] :
       {std::pair<void (*)(Accounts&), const char*>{[](Accounts& all) { all.people[0].role = Role::look; },
                                                    "another role"},
        {[](Accounts& all) { all.people[0].password_hash = *password_hash("new one"); }, "another password"},
        {[](Accounts& all) { all.people.erase(all.people.begin()); }, "it is gone"}}) {
    Accounts changed = *first;
    change(changed);
    access.use(std::make_shared<const Accounts>(std::move(changed)));
    EXPECT_EQ(access.sender(as(access, anna)).rank, 0) << what;
    EXPECT_EQ(access.sender(as(access, otto)).rank, kLook) << what;
  }
}

TEST(Access, AScriptsTokenHasItsRoleUntilItEnds) {
  Access access;
  const auto now = Access::Clock::now();
  const HttpRequest script = with("authorization", "Bearer script's");
  EXPECT_EQ(access.sender(script, now, kNoon).rank, 0);
  access.use(anna_and_otto());
  const HttpSender ci = access.sender(script, now, kNoon);
  EXPECT_EQ(ci.name, "script ci");
  EXPECT_EQ(ci.rank, kLook);
  EXPECT_TRUE(access.still(ci, now, kNoon));
  constexpr std::int64_t kFebruary = 1801440000;
  EXPECT_EQ(access.sender(script, now, kFebruary).rank, 0) << "its last day is over";
  EXPECT_FALSE(access.still(ci, now, kFebruary));
  access.use(std::make_shared<const Accounts>());
  EXPECT_FALSE(access.still(ci, now, kNoon)) << "it was taken away";
}

TEST(Access, WrongPasswordsHaveToWaitAndTheRightOneToo) {
  Access access;
  access.use(anna_and_otto());
  auto now = Access::Clock::now();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(access.log_in("anna", "wrong", "10.0.0.7", now).wait_s, 0);
  const auto refused = access.log_in("anna", "correct horse", "10.0.0.7", now);
  EXPECT_EQ(refused.wait_s, 1);
  EXPECT_EQ(refused.session, "");
  EXPECT_NE(access.log_in("anna", "correct horse", "10.0.0.8", now).session, "") << "from elsewhere";
  EXPECT_NE(access.log_in("anna", "correct horse", "10.0.0.7", now + 1s).session, "");
}

TEST(Access, OneWhoLogsInAgainAndAgainPushesNobodyOut) {
  Access access;
  access.use(anna_and_otto());
  const std::string here = *access.open(access.one_time_code());
  std::string first, last;
  for (int i = 0; i < 20; ++i) {
    last = access.log_in("anna", "correct horse", "10.0.0.7").session;
    if (i == 0) first = last;
  }
  EXPECT_EQ(access.sender(as(access, here)).rank, kConfigure);
  EXPECT_EQ(access.sender(as(access, first)).rank, 0) << "16 of one account";
  EXPECT_EQ(access.sender(as(access, last)).rank, kOperate);
}

TEST(Access, TheCookieOfHttpsGoesByHttpsAlone) {
  const Access access;
  EXPECT_NE(access.cookie("s", true).find("; Secure"), std::string::npos);
  EXPECT_EQ(access.cookie("s", false).find("; Secure"), std::string::npos);
  EXPECT_NE(access.cookie("", false).find("; Max-Age=0"), std::string::npos);
}

}  // namespace
}  // namespace luxrig
