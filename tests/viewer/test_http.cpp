// Heads of requests, and who may ask.

#include <gtest/gtest.h>

#include "holotrace/viewer/http.h"

namespace holotrace::test {
namespace {

TEST(Http, ReadsAHead) {
  const auto request = parse_head("GET /a/b?c=d&e HTTP/1.1\r\nHost: 127.0.0.1:80\r\nX-Empty:\r\nAccept:  a \t\r\n\r\n");
  ASSERT_TRUE(request);
  EXPECT_EQ(request->method, "GET");
  EXPECT_EQ(request->path, "/a/b");
  EXPECT_EQ(request->query, "c=d&e");
  EXPECT_EQ(request->header("host"), "127.0.0.1:80");
  EXPECT_EQ(request->header("accept"), "a");
  EXPECT_EQ(request->header("x-empty"), "");
  EXPECT_EQ(request->header("cookie"), "");
}

TEST(Http, RefusesWhatIsNotARequest) {
  for (const char* head :
       {"", "\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/2\r\n\r\n", "GET  / HTTP/1.1\r\n\r\n",
        "GET / /b HTTP/1.1\r\n\r\n", "GET http://a/ HTTP/1.1\r\n\r\n", "G(T / HTTP/1.1\r\n\r\n",
        "GET /\x01 HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\n\n", "GET / HTTP/1.1\r\nHost\r\n\r\n",
        "GET / HTTP/1.1\r\n: a\r\n\r\n", "GET / HTTP/1.1\r\nA: \x80\r\n\r\n", "GET / HTTP/1.1\r\nA: b\r\n c\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", "GET / HTTP/1.1\r\nOrigin: a\r\nORIGIN: b\r\n\r\n",
        "GET / HTTP/1.1\r\nA: b\r\n", "GET / HTTP/1.1\r\n\r\nmore"})
    EXPECT_FALSE(parse_head(head)) << head;
}

TEST(Http, FindsTheEndOfAHead) {
  EXPECT_EQ(end_of_head("GET / HTTP/1.1\r\n\r"), std::nullopt);
  EXPECT_EQ(end_of_head("GET / HTTP/1.1\r\n\r\nbody"), 18u);  // 14 of the line and two ends of lines
}

TEST(Http, KeepsThePageToItself) {
  const std::string head = head_of({200, "text/html", "12345"});
  for (const char* line : {"HTTP/1.1 200 OK\r\n", "Content-Length: 5\r\n", "default-src 'none'; script-src 'self';",
                           "frame-ancestors 'none'", "Referrer-Policy: no-referrer\r\n", "nosniff", "no-store"})
    EXPECT_NE(head.find(line), std::string::npos) << line;
  EXPECT_EQ(head.find("unsafe"), std::string::npos);
}

TEST(Http, FramesOfThisMachineAlone) {
  HttpAnswer answer{200, "text/html", "12345"};
  answer.may_be_framed = true;
  const std::string head = head_of(answer);
  EXPECT_NE(head.find("; frame-ancestors http://localhost:* http://127.0.0.1:* vscode-webview: vscode-file:\r\n"),
            std::string::npos);
  EXPECT_NE(head.find("default-src 'none'; script-src 'self';"), std::string::npos);  // all else is as it was
}

class AccessOf : public ::testing::Test {
 protected:
  static HttpRequest request(const std::string& path, const std::map<std::string, std::string>& headers) {
    return {"GET", path, "", headers};
  }
  static bool is_allowed(const Access& access, const std::string& path,
                         const std::map<std::string, std::string>& headers) {
    return access.refusal(request(path, headers)).empty();
  }
  const Access access{"secret", "127.0.0.1", 8080};
  const std::map<std::string, std::string> own{{"host", "127.0.0.1:8080"}};
};

TEST_F(AccessOf, AToken) {
  EXPECT_TRUE(is_allowed(access, "/secret/", own));
  EXPECT_TRUE(is_allowed(access, "/secret/view", own));
  for (const char* path :
       {"/", "//", "/secret", "/secre/", "/secrets/", "/Secret/", "/other/secret/", "/%73ecret/", "/secret%2f"})
    EXPECT_FALSE(is_allowed(access, path, own)) << path;
  EXPECT_EQ(access.inner_path(request("/secret/view", own)), "view");
}

TEST_F(AccessOf, AHost) {
  for (const char* host : {"127.0.0.1:8080", "localhost:8080"})
    EXPECT_TRUE(is_allowed(access, "/secret/", {{"host", host}})) << host;
  for (const char* host : {"", "127.0.0.1", "127.0.0.1:8081", "evil.example:8080", "127.0.0.1.evil.example:8080",
                           "evil.example", "localhost.evil.example:8080", "0.0.0.0:8080", "[::1]:8080"})
    EXPECT_FALSE(is_allowed(access, "/secret/", {{"host", host}})) << host;
  const Access v6{"secret", "::1", 8080}, any{"secret", "0.0.0.0", 8080};
  EXPECT_TRUE(is_allowed(v6, "/secret/", {{"host", "[::1]:8080"}}));
  EXPECT_TRUE(is_allowed(v6, "/secret/", {{"host", "[0:0::1]:8080"}}));
  EXPECT_TRUE(is_allowed(any, "/secret/", {{"host", "192.168.1.7:8080"}}));
  EXPECT_FALSE(is_allowed(any, "/secret/", {{"host", "evil.example:8080"}}));
  const Access usual{"secret", "127.0.0.1", 80}, usual_v6{"secret", "::1", 80};  // browsers leave out port 80
  EXPECT_TRUE(is_allowed(usual, "/secret/", {{"host", "127.0.0.1"}}));
  EXPECT_TRUE(is_allowed(usual, "/secret/", {{"host", "127.0.0.1:80"}}));
  EXPECT_TRUE(is_allowed(usual_v6, "/secret/", {{"host", "[::1]"}}));
  EXPECT_FALSE(is_allowed(usual, "/secret/", {{"host", "127.0.0.1:8080"}}));
  EXPECT_FALSE(is_allowed(usual, "/secret/", {{"host", "evil.example"}}));
}

TEST_F(AccessOf, AnOrigin) {
  const auto with = [&](const std::string& name, const std::string& value) {
    return is_allowed(access, "/secret/", {{"host", "127.0.0.1:8080"}, {name, value}});
  };
  EXPECT_TRUE(with("origin", "http://127.0.0.1:8080"));
  for (const char* origin :
       {"null", "http://evil.example", "https://127.0.0.1:8080", "http://127.0.0.1:80", "http://localhost:8080"})
    EXPECT_FALSE(with("origin", origin)) << origin;
  EXPECT_TRUE(with("sec-fetch-site", "same-origin"));
  EXPECT_TRUE(with("sec-fetch-site", "none"));
  EXPECT_FALSE(with("sec-fetch-site", "cross-site"));
  EXPECT_FALSE(with("sec-fetch-site", "same-site"));
}

// A link or a file on the disk may open the page in a tab, if it knows the token. It gets nothing of it.
TEST_F(AccessOf, ALinkToThePage) {
  const std::map<std::string, std::string> link{{"host", "127.0.0.1:8080"},
                                                {"sec-fetch-site", "cross-site"},
                                                {"sec-fetch-mode", "navigate"},
                                                {"sec-fetch-dest", "document"}};
  EXPECT_TRUE(is_allowed(access, "/secret/", link));
  EXPECT_FALSE(is_allowed(access, "/secre/", link));
  EXPECT_FALSE(is_allowed(access, "/secret/view", link));
  auto frame = link;
  frame["sec-fetch-dest"] = "iframe";
  EXPECT_FALSE(is_allowed(access, "/secret/", frame));
  auto request_of_a_script = link;
  request_of_a_script["sec-fetch-mode"] = "cors";
  EXPECT_FALSE(is_allowed(access, "/secret/", request_of_a_script));
}

TEST_F(AccessOf, AFrame) {
  const Access open{"secret", "127.0.0.1", 8080, true};
  for (const char* site : {"cross-site", "same-site"}) {
    std::map<std::string, std::string> frame{{"host", "127.0.0.1:8080"},
                                             {"sec-fetch-site", site},
                                             {"sec-fetch-mode", "navigate"},
                                             {"sec-fetch-dest", "iframe"}};
    EXPECT_TRUE(is_allowed(open, "/secret/", frame));
    EXPECT_FALSE(is_allowed(access, "/secret/", frame));
    EXPECT_FALSE(is_allowed(open, "/secre/", frame));
    EXPECT_FALSE(is_allowed(open, "/secret/view", frame));
    for (const char* place : {"embed", "object", "image", "script"}) {
      frame["sec-fetch-dest"] = place;
      EXPECT_FALSE(is_allowed(open, "/secret/", frame)) << place;
    }
  }
}

TEST(Address, IsCanonical) {
  EXPECT_EQ(canonical_address("0:0:0:0:0:0:0:1"), "::1");
  EXPECT_EQ(canonical_address("2001:DB8:0::A"), "2001:db8::a");
  EXPECT_EQ(canonical_address("127.0.0.1"), "127.0.0.1");
  EXPECT_EQ(canonical_address("example.org"), "example.org");
  EXPECT_TRUE(is_loopback(canonical_address("0::1")));
}

TEST(Token, IsLongAndNew) {
  const std::string a = make_token();
  EXPECT_EQ(a.size(), 64u);  // 32 bytes
  EXPECT_EQ(a.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_NE(a, make_token());
}

TEST(Token, IsComparedAsAWhole) {
  EXPECT_TRUE(is_equal_in_constant_time("abc", "abc"));
  EXPECT_TRUE(is_equal_in_constant_time("", ""));
  for (const char* other : {"", "a", "ab", "abd", "bbc", "abcd"})
    EXPECT_FALSE(is_equal_in_constant_time("abc", other)) << other;
  EXPECT_FALSE(is_equal_in_constant_time("", "a"));
  EXPECT_FALSE(
      is_equal_in_constant_time("abc", std::string_view("abc\0", 4)));  // 0 is what stands for a missing letter
}

}  // namespace
}  // namespace holotrace::test
