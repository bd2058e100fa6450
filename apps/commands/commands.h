#pragma once
// The subcommands. Each returns the exit code, 0 on success, and may throw base::InputError (2), base::DeviceError (3)
// or Incomplete (apps/processes/stop_signals.h). docs/ci.md lists all codes.

#include "apps/options/options.h"

namespace sf::apps {

int devices(const DevicesOptions& options);
int check(const CheckOptions& options);
int draw(const DrawOptions& options);
int field(const FieldOptions& options);
int sense(const SenseOptions& options);
int run(const RunOptions& options);
int serve(const ServeOptions& options);
int robot(const RobotOptions& options);
int light(const LightOptions& options);
int start(const StartOptions& options);
int object(const ObjectOptions& options);
int lane(const LaneOptions& options);
int plot(const PlotOptions& options);
int export_recording(const ExportOptions& options);
int view(const ViewOptions& options);
int listen(const ListenOptions& options);
int dump(const DumpOptions& options);
int experiment(const ExperimentOptions& options);
int test_scenarios(const TestOptions& options);
int sweep(const SweepOptions& options);
int map(const MapOptions& options);
int verify(const VerifyOptions& options);
int merge(const MergeOptions& options);
int derive(const DeriveOptions& options);
int identify(const IdentifyOptions& options);
int explain(const ExplainOptions& options);
int tradeoff(const TradeoffOptions& options);
int v2x_messages(const V2xOptions& options);
int selftest(const SelfTestOptions& options);
int vps(const VpsOptions& options);
int calibrate(const CalibrateOptions& options);

}  // namespace sf::apps
