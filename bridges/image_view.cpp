#include "bridges/image_view.h"

#include <algorithm>

#include "bridges/web_files.h"
#include "record/ros_messages.h"
#include "record/schemas.h"

namespace sf::bridges {

namespace {

constexpr int kMostQueued = 2;  // updates that the server's thread has not yet distributed

std::vector<record::Topic> image_topics(std::span<const std::string> cameras, bool has_tags) {
  static const std::string tags = record::schema_text(record::kTags);
  static const std::string image = record::schema_text(record::kCompressedImage);
  std::vector<record::Topic> topics;
  for (const std::string& camera : cameras)
    topics.push_back({"/" + camera + "/image/compressed", record::kCompressedImage, image});
  if (has_tags) topics.push_back({"/tags", record::kTags, tags});
  return topics;
}

std::shared_ptr<const base::Bytes> tags_message(std::int64_t time, std::span<const SeenTag> tags) {
  base::Bytes bytes;
  record::CdrWriter cdr(bytes);
  record::put_header(cdr, time, "map");
  cdr.put_count(tags.size());
  for (const SeenTag& tag : tags) {
    cdr.put(tag.id);
    for (const double value :
         {tag.X_WT.x, tag.X_WT.y, tag.X_WT.z, tag.X_WT.yaw, tag.velocity.forward, tag.velocity.left, tag.velocity.turn})
      cdr.put(value);
    cdr.put(tag.cameras);
  }
  return std::make_shared<const base::Bytes>(std::move(bytes));
}

std::shared_ptr<const base::Bytes> image_message(std::int64_t time, const std::string& camera,
                                                 const std::string& format, const base::Bytes& image) {
  base::Bytes bytes;
  record::CdrWriter cdr(bytes);
  record::put_header(cdr, time, camera);
  cdr.put(format);
  cdr.put_count(image.size());
  bytes.insert(bytes.end(), image.begin(), image.end());
  return std::make_shared<const base::Bytes>(std::move(bytes));
}

}  // namespace

ImageView::ImageView(const std::string& name, std::span<const std::string> cameras, const ImageViewOptions& options)
    : cameras_(cameras.begin(), cameras.end()),
      format_(options.format),
      topics_(image_topics(cameras, options.tags)),
      wishes_(topics_.size()),
      sessions_({name, ViewerMode::service, 0, 0, {}}, topics_, wishes_),
      interval_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.interval))) {
  WebOptions web{options.address, {kSdkV1, kWebSocketV1}, web_files(), options.limits};
  web.files["/"] = web.files.at("/cameras.html");
  web.files.erase("/index.html");
  server_ = std::make_unique<WebServer>(std::move(web), sessions_);
  server_->post([this] { sessions_.start(*server_, {}); });
}

ImageView::~ImageView() = default;

std::optional<std::vector<std::size_t>> ImageView::wanted() {
  asked_ = Clock::now();
  if (sessions_.empty() || asked_ < next_ || waiting_ >= kMostQueued) return std::nullopt;
  subscribed_.clear();
  fresh_.clear();
  wishes_.topics(subscribed_, fresh_);
  std::vector<std::size_t> cameras;
  for (const std::uint32_t topic : subscribed_)
    if (topic < cameras_.size()) cameras.push_back(topic);
  return cameras;
}

void ImageView::publish(std::int64_t time, std::vector<CameraPicture> pictures, std::span<const SeenTag> tags) {
  const auto tags_topic = static_cast<std::uint32_t>(cameras_.size());
  std::vector<SharedMessage> update;
  if (topics_.size() > tags_topic) update.push_back({tags_topic, time, tags_message(time, tags)});
  for (const CameraPicture& picture : pictures)
    update.push_back({static_cast<std::uint32_t>(picture.camera), time,
                      image_message(time, cameras_.at(picture.camera), format_, picture.bytes)});
  const Clock::time_point now = Clock::now();
  next_ = std::max(asked_ + interval_, now + 2 * (now - asked_));
  ++waiting_;
  server_->post([this, time, update = std::move(update)] {
    --waiting_;
    sessions_.update(time, update);
  });
}

}  // namespace sf::bridges
