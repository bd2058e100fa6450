#pragma once
// The subcommands. Each returns the exit code: 0 when all went well. They throw base::InputError (2) and
// base::DeviceError (3).

#include "apps/options.h"

namespace sf::apps {

int devices(const Options& options);
int check(const Options& options);
int draw(const Options& options);
int field(const Options& options);
int sense(const Options& options);
int run(const Options& options);
int serve(const Options& options);
int robot(const Options& options);
int start(const Options& options);
int plot(const Options& options);
int listen(const Options& options);
int experiment(const Options& options);
int test_scenarios(const Options& options);
int map(const Options& options);
int verify(const Options& options);
int explain(const Options& options);
int tradeoff(const Options& options);
int selftest(const Options& options);

}  // namespace sf::apps
