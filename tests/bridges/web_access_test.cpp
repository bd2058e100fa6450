// Addresses, names, origins and tokens.

#include <gtest/gtest.h>

#include "bridges/web_access.h"

namespace sf::bridges {

TEST(WebAddress, IsAPortAHostOrBoth) {
  const auto is = [](const char* text, const char* host, std::uint16_t port) {
    const auto address = read_web_address(text);
    ASSERT_TRUE(address) << text;
    EXPECT_EQ(address->host, host) << text;
    EXPECT_EQ(address->port, port) << text;
  };
  is("8765", "127.0.0.1", 8765);
  is("0", "127.0.0.1", 0);          // any free port
  is("65535", "127.0.0.1", 65535);  // the last port
  is("0.0.0.0:80", "0.0.0.0", 80);  // all interfaces
  is("192.168.1.5", "192.168.1.5", 8765);
  is("localhost:9000", "127.0.0.1", 9000);
  for (const char* wrong : {"", "65536", "-1", "80x", ":", "localhost:", ":80", "1.2.3:80", "1.2.3.256:80",
                            "1.2.3.4.5:80", "host:80", "worlds/cave.world", "8765 "})
    EXPECT_FALSE(read_web_address(wrong)) << wrong;
}

TEST(WebAccess, AcceptsItsOwnNames) {
  for (const char* own : {"localhost", "LOCALHOST:8765", "127.0.0.1:1", "127.1.2.3", "[::1]:8765", "[::1]"})
    EXPECT_TRUE(is_own_name(own)) << own;
  // A name that resolves to 127.0.0.1 (DNS rebinding), and names that begin like local ones.
  for (const char* foreign : {"", "evil.example:8765", "localhost.evil.example", "127.0.0.1.evil.example", "10.0.0.1",
                              "[", "[::1].evil.example", "[::1].evil.example:8765", "[::1]evil", "[::1", "[::1]:80:80",
                              "[::1]:evil", "localhost:80.evil.example", "localhost:evil", "localhost:65536",
                              "127.0.0.1:80:evil.example", "localhost@evil", "evil@localhost", ":80"})
    EXPECT_FALSE(is_own_name(foreign)) << foreign;
}

TEST(WebAccess, AcceptsOnlyKnownOrigins) {
  const char* const host = "192.168.1.5:8765";
  for (const char* known : {"", "http://192.168.1.5:8765", "http://localhost:8080", "http://127.0.0.1", "file://",
                            "https://app.foxglove.dev"})
    EXPECT_TRUE(is_known_origin(known, host)) << known;
  for (const char* foreign :
       {"null", "https://evil.example", "http://192.168.1.5:80", "https://app.foxglove.dev.evil.example",
        "http://localhost.evil.example", "https://evil.example/localhost", "http://[::1].evil.example",
        "http://localhost:80.evil.example"})
    EXPECT_FALSE(is_known_origin(foreign, host)) << foreign;
}

TEST(WebAccess, FindsValuesOfQueries) {
  EXPECT_EQ(query_value("/?token=abc", "token"), "abc");
  EXPECT_EQ(query_value("/x?a=1&token=abc&b=2", "token"), "abc");
  EXPECT_EQ(query_value("/?mytoken=abc", "token"), "");  // another key with that ending
  EXPECT_EQ(query_value("/?token2=abc", "token"), "");   // another key with that beginning
  EXPECT_EQ(query_value("/?token", "token"), "");        // without a value
  EXPECT_EQ(query_value("/token=abc", "token"), "");     // not a query
  EXPECT_EQ(query_value("/?&&", "token"), "");
}

TEST(WebAccess, TokensAreNewAndComparedCompletely) {
  const std::string token = random_token();
  EXPECT_EQ(token.size(), 32u);
  EXPECT_NE(token, random_token());
  EXPECT_TRUE(same_token(token, token));
  EXPECT_FALSE(same_token(token.substr(1), token));
  EXPECT_FALSE(same_token(token + "0", token));
  EXPECT_FALSE(same_token("", token));
  EXPECT_FALSE(same_token("", "")) << "an empty token grants no access";
}

}  // namespace sf::bridges
