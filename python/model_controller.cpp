// Controllers of models written in Python.

#include <array>
#include <memory>
#include <stdexcept>

#include "python/controllers.h"
#include "python/types.h"

namespace sensorfarm::python {

namespace py = pybind11;

namespace {

/// The model during a call; null afterwards.
struct LentModel {
  Model* model = nullptr;
  Model& get() const {
    if (model == nullptr) throw py::value_error("a model can be used during the call that receives it only");
    return *model;
  }
};

struct OwnedRobot {
  std::string name;
  NearRobot robot;
};

struct OwnedContact {
  std::string name;
  ModelContact contact;
};

py::list robots_of(const LentModel& model) {
  py::list robots;
  for (const NearRobot& robot : model.get().robots()) robots.append(OwnedRobot{std::string(robot.name), robot});
  return robots;
}

/// Errors of `call` become ValueError in Python.
template <class Call>
void change(Call&& call) {
  try {
    call();
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::exception& error) {
    throw py::value_error(error.what());
  }
}

void add_model(py::module_& module) {
  using Given = const LentModel&;
  py::class_<LentModel>(module, "Model", py::module_local(), "The model in one call: its state, and changes.")
      .def_property_readonly("time", [](Given m) { return m.get().time(); })
      .def_property_readonly("pose", [](Given m) { return m.get().pose(); })
      .def_property_readonly("velocity", [](Given m) { return m.get().velocity(); })
      .def_property_readonly("present", [](Given m) { return m.get().present(); })
      .def_property_readonly("robots", &robots_of)
      .def(
          "set_pose", [](Given m, const Pose& pose) { change([&] { m.get().set_pose(pose); }); }, py::arg("pose"))
      .def(
          "set_velocity", [](Given m, const Twist& twist) { change([&] { m.get().set_velocity(twist); }); },
          py::arg("velocity"))
      .def(
          "set_present", [](Given m, bool present) { m.get().set_present(present); }, py::arg("present"))
      .def(
          "set_shape", [](Given m, const std::string& name) { change([&] { m.get().set_shape(name); }); },
          py::arg("name"))
      .def(
          "set_size",
          [](Given m, const std::array<double, 3>& s) { change([&] { m.get().set_size(s[0], s[1], s[2]); }); },
          py::arg("size"))
      .def(
          "set_color", [](Given m, const std::string& color) { change([&] { m.get().set_color(color); }); },
          py::arg("color"))
      .def("uniform", [](Given m) { return m.get().uniform(); })
      .def("normal", [](Given m) { return m.get().normal(); });
}

class PythonModelController final : public ModelController {
 public:
  PythonModelController(std::string file, py::object object) : file_(std::move(file)), object_(std::move(object)) {}

  void tick(Model& model) override {
    lend(model, [&](const py::object& lent) { object_->attr("tick")(lent); });
  }
  void contact(const ModelContact& contact, Model& model) override {
    lend(model, [&](const py::object& lent) {
      if (py::hasattr(*object_, "contact"))
        object_->attr("contact")(OwnedContact{std::string(contact.name), contact}, lent);
    });
  }
  double range() const override {
    return in_python(file_, [&] {
      if (!py::hasattr(*object_, "range")) return 0.0;
      const py::object range = object_->attr("range")();
      if (!py::isinstance<py::float_>(range) && !py::isinstance<py::int_>(range))
        throw std::runtime_error(place_of(object_->attr("range")) + "range() returned " + object_text(py::repr(range)) +
                                 "; expected a number");
      return range.cast<double>();
    });
  }

 private:
  template <class Call>
  void lend(Model& model, Call&& call) {
    in_python(file_, [&] {
      const py::object lent = py::cast(LentModel{&model});
      struct Return {
        LentModel& lent;
        ~Return() { lent.model = nullptr; }
      } const give_back{lent.cast<LentModel&>()};
      call(lent);
    });
  }

  std::string file_;
  HeldObject object_;
};

}  // namespace

void add_model_types(py::module_& module) {
  py::class_<ModelSite>(module, "ModelSite", py::module_local(), "A model at the start: metres, radians, m/s, rad/s.")
      .def_readonly("name", &ModelSite::name)
      .def_readonly("row", &ModelSite::row)
      .def_readonly("pose", &ModelSite::pose)
      .def_readonly("radius", &ModelSite::radius)
      .def_readonly("max_forward", &ModelSite::max_forward)
      .def_readonly("max_turn", &ModelSite::max_turn)
      .def_readonly("interval", &ModelSite::interval)
      .def_readonly("seed", &ModelSite::seed)
      .def_readonly("world", &ModelSite::world);
  py::class_<OwnedRobot>(module, "NearRobot", py::module_local(), "A robot near a model.")
      .def_readonly("name", &OwnedRobot::name)
      .def_property_readonly("row", [](const OwnedRobot& r) { return r.robot.row; })
      .def_property_readonly("pose", [](const OwnedRobot& r) { return r.robot.pose; })
      .def_property_readonly("velocity", [](const OwnedRobot& r) { return r.robot.velocity; })
      .def_property_readonly("radius", [](const OwnedRobot& r) { return r.robot.radius; })
      .def_property_readonly("distance", [](const OwnedRobot& r) { return r.robot.distance; });
  py::class_<OwnedContact>(module, "ModelContact", py::module_local(), "The beginning of a contact of a model.")
      .def_readonly("name", &OwnedContact::name)
      .def_property_readonly("row",
                             [](const OwnedContact& c) {
                               return c.contact.row == kNone ? py::object(py::none())
                                                             : py::object(py::int_(c.contact.row));
                             })
      .def_property_readonly("robot", [](const OwnedContact& c) { return c.contact.robot; })
      .def_property_readonly("point", [](const OwnedContact& c) { return py::make_tuple(c.contact.x, c.contact.y); });
  add_model(module);
}

ModelEntry model_entry_of(py::handle type) {
  ModelEntry entry;
  entry.name = type.attr("__name__").cast<std::string>();
  entry.summary = first_line(type.attr("__doc__"));
  type.inc_ref();  // for the rest of the program
  entry.make = [type, file = file_of(type)](const ModelSite& site, Settings& settings) {
    return in_python(file, [&]() -> std::unique_ptr<ModelController> {
      check_constructor(type, "model");
      py::object object = with_settings(settings, type, py::cast(site));
      check_method(object, "tick", "(self, model)", 1);
      check_method(object, "contact", "(self, contact, model)", 2);
      check_method(object, "range", "(self)", 0);
      return std::make_unique<PythonModelController>(file, std::move(object));
    });
  };
  return entry;
}

}  // namespace sensorfarm::python
