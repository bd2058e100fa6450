#include <X11/Xlib.h>
#include <vtkActor.h>
#include <vtkAutoInit.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellData.h>
#include <vtkCellDataToPointData.h>
#include <vtkContourFilter.h>
#include <vtkImageData.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkProperty2D.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSliderRepresentation2D.h>
#include <vtkSliderWidget.h>
#include <vtkSmartPointer.h>
#include <vtkStreamTracer.h>
#include <vtkTextProperty.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWidgetEvent.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "viz/vtk/convert.h"
#include "viz/vtk/plugin.h"

// Factories of classes that VTK creates by name.
VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingFreeType)
VTK_MODULE_INIT(vtkInteractionStyle)

namespace sf::viz {
namespace {

constexpr int kContours = 10;
constexpr int kSeeds = 14;           // number of stream lines along each side
constexpr unsigned long kTick = 50;  // [ms] between frames while playing

/// Returns `data` with its `rgb` as the colours that VTK paints.
vtkSmartPointer<vtkPolyData> painted(const PolyData& data) {
  auto out = vtkSmartPointer<vtkPolyData>::Take(new_poly_data(data));
  for (const DataArray& array : data.cell_data) {
    if (array.name != "rgb") continue;
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetName("colors");
    colors->SetNumberOfComponents(3);
    for (const double part : array.values) colors->InsertNextValue(static_cast<unsigned char>(part));
    out->GetCellData()->SetScalars(colors);
  }
  return out;
}

/// An object in the scene.
struct Part {
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;
  Part() {
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(0.45);
    actor->GetProperty()->SetDiffuse(0.6);
  }
  void set(const PolyData& data) {
    vtkNew<vtkTriangleFilter> triangles;  // outlines may be concave
    triangles->SetInputData(painted(data));
    triangles->Update();
    mapper->SetInputData(triangles->GetOutput());
  }
};

class Window {
 public:
  explicit Window(const Scene3d& scene) : scene_(scene), row_(std::min(scene.first, scene.times.size() - 1)) {
    renderer_->GradientBackgroundOn();
    renderer_->SetBackground(0.93, 0.94, 0.96);
    renderer_->SetBackground2(0.75, 0.80, 0.87);
    window_->SetSize(scene.width, scene.height);
    window_->SetWindowName(scene.title.c_str());
    window_->SetMultiSamples(4);
    window_->AddRenderer(renderer_);
    interactor_->SetRenderWindow(window_);
    interactor_->SetInteractorStyle(style_);
    add_parts();
    if (scene.field) add_field(*scene.field);
    add_slider();
    show_row();
    place_camera();
  }

  void picture(PixelImage& out) {
    window_->Render();
    vtkNew<vtkWindowToImageFilter> filter;
    filter->SetInput(window_);
    filter->ReadFrontBufferOff();
    filter->Update();
    vtkImageData* image = filter->GetOutput();
    int size[3];
    image->GetDimensions(size);
    out = {size[0], size[1], {}};
    for (int y = size[1] - 1; y >= 0; --y) {
      const auto* row = static_cast<const unsigned char*>(image->GetScalarPointer(0, y, 0));
      out.rgb.insert(out.rgb.end(), row, row + 3 * size[0]);
    }
  }

  void run() {
    window_->Render();
    vtkNew<vtkCallbackCommand> on_event;
    on_event->SetClientData(this);
    on_event->SetCallback(
        [](vtkObject*, unsigned long event, void* self, void*) { static_cast<Window*>(self)->handle(event); });
    interactor_->AddObserver(vtkCommand::TimerEvent, on_event);
    interactor_->AddObserver(vtkCommand::KeyPressEvent, on_event);
    slider_->AddObserver(vtkCommand::InteractionEvent, on_event);
    interactor_->CreateRepeatingTimer(kTick);
    if (scene_.opened) scene_.opened();
    interactor_->Start();
  }

 private:
  void add_parts() {
    walls_.set(scene_.walls);
    roads_.set(scene_.roads);
    roads_.actor->GetProperty()->SetLineWidth(2.0f);
    beams_.actor->GetProperty()->SetColor(0.1, 0.4, 0.9);
    beams_.actor->GetProperty()->SetOpacity(0.25);
    clouds_.actor->GetProperty()->SetColor(0.1, 0.4, 0.9);
    clouds_.actor->GetProperty()->SetPointSize(2.0f);
    clouds_.actor->GetProperty()->LightingOff();
    for (Part* part : {&walls_, &roads_, &beams_, &bodies_, &lights_, &clouds_}) renderer_->AddActor(part->actor);
  }

  /// Adds contours of the magnitude at logarithmic steps, and stream lines of the field in the plane.
  void add_field(const GridData& grid) {
    const auto image = vtkSmartPointer<vtkImageData>::Take(new_image(grid));
    vtkNew<vtkCellDataToPointData> points;
    points->SetInputData(image);
    points->Update();
    vtkDataSet* field = points->GetOutput();
    double range[2] = {0.0, 1.0};
    field->GetPointData()->GetArray("magnitude")->GetRange(range);
    if (!(range[1] > 0.0)) return;
    field->GetPointData()->SetActiveScalars("magnitude");
    field->GetPointData()->SetActiveVectors("in_plane");
    vtkNew<vtkContourFilter> contours;
    contours->SetInputData(field);
    contours->SetNumberOfContours(kContours);
    const double low = std::max(range[0], 1e-3 * range[1]);
    for (int k = 0; k < kContours; ++k) contours->SetValue(k, low * std::pow(range[1] / low, (k + 0.5) / kContours));
    field_.mapper->SetInputConnection(contours->GetOutputPort());
    field_.mapper->SetScalarRange(low, range[1]);
    field_.actor->GetProperty()->SetLineWidth(2.0f);

    PolyData seeds;
    for (int j = 0; j < kSeeds; ++j)
      for (int i = 0; i < kSeeds; ++i)
        seeds.points.push_back({grid.x + (i + 0.5) / kSeeds * grid.columns * grid.cell_x,
                                grid.y + (j + 0.5) / kSeeds * grid.rows * grid.cell_y, grid.z});
    vtkNew<vtkStreamTracer> tracer;
    tracer->SetInputData(field);
    tracer->SetSourceData(vtkSmartPointer<vtkPolyData>::Take(new_poly_data(seeds)));
    tracer->SetIntegrationDirectionToBoth();
    tracer->SetMaximumPropagation(std::max(grid.columns * grid.cell_x, grid.rows * grid.cell_y));
    stream_.mapper->SetInputConnection(tracer->GetOutputPort());
    stream_.mapper->ScalarVisibilityOff();
    stream_.actor->GetProperty()->SetColor(0.25, 0.25, 0.3);
    stream_.actor->GetProperty()->SetOpacity(0.5);
    renderer_->AddActor(field_.actor);
    renderer_->AddActor(stream_.actor);
  }

  void add_slider() {
    vtkNew<vtkSliderRepresentation2D> look;
    look->SetMinimumValue(scene_.times.front());
    look->SetMaximumValue(std::max(scene_.times.back(), scene_.times.front() + 1e-9));
    look->SetTitleText("time [s]");
    look->SetLabelFormat("%.2f");
    look->GetPoint1Coordinate()->SetCoordinateSystemToNormalizedDisplay();
    look->GetPoint1Coordinate()->SetValue(0.1, 0.08);
    look->GetPoint2Coordinate()->SetCoordinateSystemToNormalizedDisplay();
    look->GetPoint2Coordinate()->SetValue(0.9, 0.08);
    look->SetTitleHeight(0.02);
    look->SetLabelHeight(0.02);
    for (vtkTextProperty* text : {look->GetTitleProperty(), look->GetLabelProperty()}) {
      text->SetColor(0.1, 0.1, 0.1);
      text->SetShadow(0);
    }
    look->GetTubeProperty()->SetColor(0.5, 0.5, 0.55);
    look->GetSliderProperty()->SetColor(0.0, 0.45, 0.7);
    slider_->SetInteractor(interactor_);
    slider_->SetRepresentation(look);
    slider_->SetAnimationModeToJump();
    slider_->EnabledOn();
  }

  void show_row() {
    const Frame3d frame = scene_.frame(row_);
    bodies_.set(frame.bodies);
    beams_.set(frame.beams);
    lights_.set(frame.lights);
    clouds_.set(frame.clouds);
    static_cast<vtkSliderRepresentation2D*>(slider_->GetRepresentation())->SetValue(scene_.times[row_]);
  }

  /// Views the scene from the south, at 55 degrees. Echoes far beyond the walls do not make it smaller.
  void place_camera() {
    clouds_.actor->UseBoundsOff();
    renderer_->ResetCamera();
    vtkCamera* camera = renderer_->GetActiveCamera();
    double at[3];
    camera->GetFocalPoint(at);
    const double away = camera->GetDistance();
    camera->SetPosition(at[0], at[1] - 0.57 * away, at[2] + 0.82 * away);
    camera->SetViewUp(0.0, 1.0, 0.0);
    renderer_->ResetCamera();
    camera->Zoom(1.25);
    clouds_.actor->UseBoundsOn();
    renderer_->ResetCameraClippingRange();
  }

  void go_to(std::size_t row) {
    row_ = row;
    show_row();
    interactor_->Render();
  }

  void handle(unsigned long event) {
    const std::size_t last = scene_.times.size() - 1;
    if (event == vtkCommand::TimerEvent) {
      if (scene_.stop && scene_.stop()) return interactor_->TerminateApp();
      if (playing_) go_to(row_ < last ? row_ + 1 : 0);
    } else if (event == vtkCommand::InteractionEvent) {
      const double time = static_cast<vtkSliderRepresentation2D*>(slider_->GetRepresentation())->GetValue();
      const auto next = std::lower_bound(scene_.times.begin(), scene_.times.end(), time);
      go_to(std::min(static_cast<std::size_t>(next - scene_.times.begin()), last));
    } else {
      const std::string key = interactor_->GetKeySym() != nullptr ? interactor_->GetKeySym() : "";
      if (key == "space") playing_ = !playing_;
      if (key == "Right" && row_ < last) go_to(row_ + 1);
      if (key == "Left" && row_ > 0) go_to(row_ - 1);
    }
  }

  const Scene3d& scene_;
  std::size_t row_;
  bool playing_ = false;
  vtkNew<vtkRenderer> renderer_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  vtkNew<vtkInteractorStyleTrackballCamera> style_;
  vtkNew<vtkSliderWidget> slider_;
  Part walls_, roads_, beams_, bodies_, lights_, clouds_, field_, stream_;
};

}  // namespace

std::string show_scene(const Scene3d& scene, PixelImage* picture) {
  // VTK ends the process if there is no display, so check first. Keep the connection open: an X server resets when its
  // only client disconnects, which would break VTK's connection.
  const std::unique_ptr<Display, decltype(&XCloseDisplay)> display(XOpenDisplay(nullptr), &XCloseDisplay);
  if (display == nullptr)
    return "no display: the window needs X11; set DISPLAY, run it under xvfb-run, or use `view DIR` in a browser";
  vtkObject::GlobalWarningDisplayOff();
  Window window(scene);
  if (picture != nullptr)
    window.picture(*picture);
  else
    window.run();
  return "";
}

}  // namespace sf::viz
