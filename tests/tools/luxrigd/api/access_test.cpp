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

TEST(Access, AcceptsOnlyItsToken) {
  const Access access, other;
  EXPECT_EQ(access.token().size(), 64u);
  EXPECT_NE(access.token(), other.token());
  EXPECT_EQ(access.credential(with("authorization", "Bearer " + access.token())), "token");
  for (const std::string& wrong : {std::string(), std::string("Bearer "), "Bearer " + other.token(), access.token(),
                                   "bearer" + access.token(), "Bearer " + access.token() + "0"})
    EXPECT_EQ(access.credential(with("authorization", wrong)), "") << wrong;
  EXPECT_EQ(access.credential({}), "");
  EXPECT_EQ(access.credential(with("cookie", "luxrig_session=" + access.token())), "");
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

  const std::string cookie = access.cookie(*session);
  EXPECT_NE(cookie.find("HttpOnly; SameSite=Strict; Path=/"), std::string::npos) << cookie;
  EXPECT_EQ(access.credential(with("cookie", returned(cookie))), *session);
  EXPECT_EQ(access.credential(with("cookie", "a=b; " + returned(cookie) + "; c=d")), *session);
  EXPECT_EQ(access.credential(with("cookie", "luxrig_session_9621=" + *session)), "") << "another daemon's";
  EXPECT_EQ(access.credential(with("cookie", "luxrig_session_9620=")), "");
}

TEST(Access, RemembersALimitedNumberOfBrowsers) {
  Access access;
  std::string first, last;
  for (int i = 0; i < 65; ++i) {
    last = *access.open(access.one_time_code());
    if (i == 0) first = last;
  }
  EXPECT_EQ(access.credential(with("cookie", returned(access.cookie(first)))), "");
  EXPECT_EQ(access.credential(with("cookie", returned(access.cookie(last)))), last);
  const std::string oldest = access.one_time_code();
  for (int i = 0; i < 64; ++i) (void)access.one_time_code();
  EXPECT_FALSE(access.open(oldest));
}

}  // namespace
}  // namespace luxrig
