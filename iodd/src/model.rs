//! The FS part of an IODD as values that know their places. Nothing is judged here: what is missing or malformed stays visible.

use crate::text::Unreadable;
use roxmltree::{Document, Node};
use std::collections::HashMap;
use std::rc::Rc;

/// The namespace of `xsi:type`.
const XSI: &str = "http://www.w3.org/2001/XMLSchema-instance";

/// An IODD. Every `at` is the octet where the element begins; that of a missing collection is its parent's.
pub(crate) struct Iodd<'a> {
    pub(crate) at: usize,
    pub(crate) features: Option<Features<'a>>,
    pub(crate) variables_at: usize,
    pub(crate) standard: Vec<StdVariable<'a>>,
    pub(crate) variables: Vec<Variable<'a>>,
    pub(crate) process_data_at: usize,
    pub(crate) process_data: Vec<ProcessData<'a>>,
    pub(crate) events_at: usize,
    pub(crate) events: Vec<Event<'a>>,
    pub(crate) shown_at: usize,
    pub(crate) shown: Vec<Shown<'a>>,
    pub(crate) menus_at: usize,
    pub(crate) menus: Vec<Menu<'a>>,
    pub(crate) roles: Vec<Role<'a>>,
    pub(crate) language: Option<Language<'a>>,
}

/// `Features`.
pub(crate) struct Features<'a> {
    pub(crate) at: usize,
    pub(crate) data_storage: Option<&'a str>,
    pub(crate) profiles: Vec<&'a str>,
}

/// `StdVariableRef`: a variable the base standard defines.
pub(crate) struct StdVariable<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    pub(crate) fixed_length: Option<&'a str>,
    pub(crate) values: Vec<(usize, &'a str)>,
}

/// `Variable`.
pub(crate) struct Variable<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    pub(crate) index: Option<u64>,
    pub(crate) access: &'a str,
    pub(crate) default: Option<&'a str>,
    pub(crate) data: Rc<Data<'a>>,
    pub(crate) infos: Vec<Info<'a>>,
}

/// `RecordItemInfo`: the default of one item.
pub(crate) struct Info<'a> {
    pub(crate) at: usize,
    pub(crate) subindex: Option<u64>,
    pub(crate) default: Option<&'a str>,
}

/// A data type, references followed.
#[derive(Default)]
pub(crate) struct Data<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    /// `UIntegerT`, `RecordT`; empty where there is none.
    pub(crate) kind: &'a str,
    pub(crate) bits: Option<u64>,
    pub(crate) fixed_length: Option<u64>,
    pub(crate) encoding: &'a str,
    pub(crate) subindex_access: Option<&'a str>,
    pub(crate) singles: Vec<Single<'a>>,
    pub(crate) ranges: Vec<Range<'a>>,
    pub(crate) items: Vec<Item<'a>>,
}

/// `SingleValue`.
pub(crate) struct Single<'a> {
    pub(crate) at: usize,
    pub(crate) value: &'a str,
    pub(crate) name: Option<&'a str>,
}

/// `ValueRange`.
pub(crate) struct Range<'a> {
    pub(crate) at: usize,
    pub(crate) lower: &'a str,
    pub(crate) upper: &'a str,
}

/// `RecordItem`.
pub(crate) struct Item<'a> {
    pub(crate) at: usize,
    pub(crate) subindex: Option<u64>,
    pub(crate) offset: Option<u64>,
    pub(crate) data: Rc<Data<'a>>,
    pub(crate) name: &'a str,
    pub(crate) description: Option<&'a str>,
}

/// `ProcessData`.
pub(crate) struct ProcessData<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    pub(crate) condition: Option<usize>,
    pub(crate) input: Option<Direction<'a>>,
    pub(crate) output: Option<Direction<'a>>,
}

/// `ProcessDataIn` or `ProcessDataOut`.
pub(crate) struct Direction<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    pub(crate) bits: Option<u64>,
    pub(crate) data: Rc<Data<'a>>,
}

/// `Event`.
pub(crate) struct Event<'a> {
    pub(crate) at: usize,
    pub(crate) code: Option<u64>,
    pub(crate) kind: &'a str,
    pub(crate) name: &'a str,
    pub(crate) description: Option<&'a str>,
}

/// `ProcessDataRef`: process data as a tool shows it.
pub(crate) struct Shown<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    pub(crate) items: Vec<(usize, Option<u64>, Option<&'a str>)>,
}

/// `Menu`.
pub(crate) struct Menu<'a> {
    pub(crate) at: usize,
    pub(crate) id: &'a str,
    pub(crate) entries: Vec<Entry<'a>>,
}

/// One line of a menu.
pub(crate) struct Entry<'a> {
    pub(crate) at: usize,
    pub(crate) target: Target<'a>,
    pub(crate) restriction: Option<&'a str>,
    pub(crate) format: Option<&'a str>,
    pub(crate) gradient: Option<&'a str>,
    pub(crate) offset: Option<&'a str>,
    pub(crate) unit: Option<&'a str>,
}

/// What a line of a menu shows.
#[derive(Copy, Clone, PartialEq, Eq)]
pub(crate) enum Target<'a> {
    /// A variable.
    Variable(&'a str),
    /// One item of a variable.
    Item(&'a str, Option<u64>),
    /// Another menu.
    Menu(&'a str),
}

impl<'a> Target<'a> {
    /// The variable, if it is one or part of one.
    pub(crate) fn variable(self) -> Option<&'a str> {
        match self {
            Target::Variable(id) | Target::Item(id, _) => Some(id),
            Target::Menu(_) => None,
        }
    }

    /// The menu, if it is one.
    pub(crate) fn menu(self) -> Option<&'a str> {
        match self {
            Target::Menu(id) => Some(id),
            _ => None,
        }
    }
}

/// The menus of a role.
pub(crate) struct Role<'a> {
    pub(crate) at: usize,
    /// `ObserverRoleMenuSet`.
    pub(crate) set: &'a str,
    /// `ParameterMenu` and the id it names.
    pub(crate) menus: Vec<(usize, &'a str, &'a str)>,
}

/// `PrimaryLanguage` and its texts.
pub(crate) struct Language<'a> {
    pub(crate) at: usize,
    pub(crate) name: &'a str,
    pub(crate) texts: HashMap<&'a str, (usize, &'a str)>,
}

impl<'a> Variable<'a> {
    /// The default of an item, with its place.
    pub(crate) fn default_of(&self, subindex: u64) -> Option<(usize, &'a str)> {
        let info = self.infos.iter().find(|info| info.subindex == Some(subindex))?;
        Some((info.at, info.default?))
    }
}

impl<'a> Data<'a> {
    /// Where the type stands; for a type that is missing, the place of what lacks it.
    pub(crate) fn place_or(&self, holder: usize) -> usize {
        if self.at == 0 { holder } else { self.at }
    }

    /// The item of a Subindex.
    pub(crate) fn item(&self, subindex: u64) -> Option<&Item<'a>> {
        self.items.iter().find(|item| item.subindex == Some(subindex))
    }
}

/// A number as an IODD writes it.
pub(crate) fn number(text: &str) -> Option<u64> {
    text.trim().parse().ok()
}

/// Whether a decimal attribute such as `10.0` has this value.
pub(crate) fn decimal_is(text: Option<&str>, value: f64) -> bool {
    text.and_then(|text| text.trim().parse::<f64>().ok()) == Some(value)
}

/// Whether a truth value of XML is true.
pub(crate) fn is_true(text: Option<&str>) -> bool {
    matches!(text.map(str::trim), Some("true" | "1"))
}

fn children<'a, 'i: 'a>(node: Option<Node<'a, 'i>>, name: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.into_iter()
        .flat_map(|node| node.children())
        .filter(move |child| child.is_element() && child.tag_name().name() == name)
}

fn child<'a, 'i: 'a>(node: Option<Node<'a, 'i>>, name: &'static str) -> Option<Node<'a, 'i>> {
    children(node, name).next()
}

fn at(node: Node<'_, '_>) -> usize {
    node.range().start
}

fn text<'a>(node: Node<'a, '_>, name: &str) -> &'a str {
    node.attribute(name).unwrap_or_default()
}

fn count(node: Node<'_, '_>, name: &str) -> Option<u64> {
    node.attribute(name).and_then(number)
}

/// The text id of `Name` or `Description`.
fn text_id<'a>(node: Node<'a, '_>, name: &'static str) -> Option<&'a str> {
    child(Some(node), name).and_then(|child| child.attribute("textId"))
}

/// The data types of a file by id; simple ones first, records refer to them.
struct Types<'a>(HashMap<&'a str, Rc<Data<'a>>>);

impl<'a> Types<'a> {
    fn read(collection: Option<Node<'a, '_>>) -> Types<'a> {
        let mut types = Types(HashMap::new());
        for records in [false, true] {
            for node in children(collection, "Datatype").filter(|node| (kind(*node) == "RecordT") == records) {
                let data = Rc::new(types.data(node));
                types.0.insert(text(node, "id"), data);
            }
        }
        types
    }

    /// The type of an element that holds or refers to one.
    fn of(&self, holder: Node<'a, '_>) -> Rc<Data<'a>> {
        let own = child(Some(holder), "Datatype").or_else(|| child(Some(holder), "SimpleDatatype"));
        match (own, child(Some(holder), "DatatypeRef")) {
            (Some(node), _) => Rc::new(self.data(node)),
            (None, Some(reference)) => self.0.get(text(reference, "datatypeId")).map(Rc::clone).unwrap_or_default(),
            (None, None) => Rc::default(),
        }
    }

    fn data(&self, node: Node<'a, '_>) -> Data<'a> {
        let single = |node| Single { at: at(node), value: text(node, "value"), name: text_id(node, "Name") };
        let range = |node| Range { at: at(node), lower: text(node, "lowerValue"), upper: text(node, "upperValue") };
        let item = |node| Item {
            at: at(node),
            subindex: count(node, "subindex"),
            offset: count(node, "bitOffset"),
            data: self.of(node),
            name: text_id(node, "Name").unwrap_or_default(),
            description: text_id(node, "Description"),
        };
        Data {
            at: at(node),
            id: text(node, "id"),
            kind: kind(node),
            bits: count(node, "bitLength"),
            fixed_length: count(node, "fixedLength"),
            encoding: text(node, "encoding"),
            subindex_access: node.attribute("subindexAccessSupported"),
            singles: children(Some(node), "SingleValue").map(single).collect(),
            ranges: children(Some(node), "ValueRange").map(range).collect(),
            items: children(Some(node), "RecordItem").map(item).collect(),
        }
    }
}

/// `xsi:type` without a prefix.
fn kind<'a>(node: Node<'a, '_>) -> &'a str {
    let kind = node.attribute((XSI, "type")).unwrap_or_default();
    kind.rsplit_once(':').map_or(kind, |(_, kind)| kind)
}

impl<'a> Iodd<'a> {
    /// What stands in a document.
    pub(crate) fn read(document: &'a Document<'_>) -> Result<Iodd<'a>, Unreadable> {
        let root = document.root_element();
        if root.tag_name().name() != "IODevice" {
            return Err(Unreadable::NoIodd(root.tag_name().name().to_owned()));
        }
        let function = child(child(Some(root), "ProfileBody"), "DeviceFunction");
        let function_at = function.map_or(at(root), at);
        let part = |name| child(function, name);
        let place = |node: Option<Node<'_, '_>>| node.map_or(function_at, at);
        let types = Types::read(part("DatatypeCollection"));
        let (variables, process_data) = (part("VariableCollection"), part("ProcessDataCollection"));
        let (events, interface) = (part("EventCollection"), part("UserInterface"));
        let (shown, menus) = (child(interface, "ProcessDataRefCollection"), child(interface, "MenuCollection"));
        let sets = ["ObserverRoleMenuSet", "MaintenanceRoleMenuSet", "SpecialistRoleMenuSet"];
        Ok(Iodd {
            at: at(root),
            features: part("Features").map(|node| Features {
                at: at(node),
                data_storage: node.attribute("dataStorage"),
                profiles: text(node, "profileCharacteristic").split_whitespace().collect(),
            }),
            variables_at: place(variables),
            standard: children(variables, "StdVariableRef").map(std_variable).collect(),
            variables: children(variables, "Variable").map(|node| variable(node, &types)).collect(),
            process_data_at: place(process_data),
            process_data: children(process_data, "ProcessData").map(|node| process(node, &types)).collect(),
            events_at: place(events),
            events: children(events, "Event").map(event).collect(),
            shown_at: place(shown.or(interface)),
            shown: children(shown, "ProcessDataRef").map(shown_data).collect(),
            menus_at: place(menus.or(interface)),
            menus: children(menus, "Menu").map(menu).collect(),
            roles: sets.into_iter().filter_map(|set| child(interface, set)).map(role).collect(),
            language: child(child(Some(root), "ExternalTextCollection"), "PrimaryLanguage").map(language),
        })
    }

    /// The variable at an Index.
    pub(crate) fn variable(&self, index: u64) -> Option<&Variable<'a>> {
        self.variables.iter().find(|variable| variable.index == Some(index))
    }
}

fn std_variable<'a>(node: Node<'a, '_>) -> StdVariable<'a> {
    StdVariable {
        at: at(node),
        id: text(node, "id"),
        fixed_length: node.attribute("fixedLengthRestriction"),
        values: children(Some(node), "StdSingleValueRef").map(|value| (at(value), text(value, "value"))).collect(),
    }
}

fn variable<'a>(node: Node<'a, '_>, types: &Types<'a>) -> Variable<'a> {
    let info = |node| Info { at: at(node), subindex: count(node, "subindex"), default: node.attribute("defaultValue") };
    Variable {
        at: at(node),
        id: text(node, "id"),
        index: count(node, "index"),
        access: text(node, "accessRights"),
        default: node.attribute("defaultValue"),
        data: types.of(node),
        infos: children(Some(node), "RecordItemInfo").map(info).collect(),
    }
}

fn process<'a>(node: Node<'a, '_>, types: &Types<'a>) -> ProcessData<'a> {
    let direction =
        |node| Direction { at: at(node), id: text(node, "id"), bits: count(node, "bitLength"), data: types.of(node) };
    ProcessData {
        at: at(node),
        id: text(node, "id"),
        condition: child(Some(node), "Condition").map(at),
        input: child(Some(node), "ProcessDataIn").map(direction),
        output: child(Some(node), "ProcessDataOut").map(direction),
    }
}

fn event<'a>(node: Node<'a, '_>) -> Event<'a> {
    Event {
        at: at(node),
        code: count(node, "code"),
        kind: text(node, "type"),
        name: text_id(node, "Name").unwrap_or_default(),
        description: text_id(node, "Description"),
    }
}

fn shown_data<'a>(node: Node<'a, '_>) -> Shown<'a> {
    let item = |node: Node<'a, '_>| (at(node), count(node, "subindex"), node.attribute("displayFormat"));
    Shown {
        at: at(node),
        id: text(node, "processDataId"),
        items: children(Some(node), "ProcessDataRecordItemInfo").map(item).collect(),
    }
}

fn menu<'a>(node: Node<'a, '_>) -> Menu<'a> {
    let entry = |node: Node<'a, '_>| {
        let target = match node.tag_name().name() {
            "VariableRef" => Target::Variable(text(node, "variableId")),
            "RecordItemRef" => Target::Item(text(node, "variableId"), count(node, "subindex")),
            "MenuRef" => Target::Menu(text(node, "menuId")),
            _ => return None,
        };
        Some(Entry {
            at: at(node),
            target,
            restriction: node.attribute("accessRightRestriction"),
            format: node.attribute("displayFormat"),
            gradient: node.attribute("gradient"),
            offset: node.attribute("offset"),
            unit: node.attribute("unitCode"),
        })
    };
    Menu { at: at(node), id: text(node, "id"), entries: node.children().filter_map(entry).collect() }
}

fn role<'a, 'i: 'a>(node: Node<'a, 'i>) -> Role<'a> {
    let menus = node.children().filter(|child| child.is_element());
    Role {
        at: at(node),
        set: node.tag_name().name(),
        menus: menus.map(|menu| (at(menu), menu.tag_name().name(), text(menu, "menuId"))).collect(),
    }
}

fn language<'a>(node: Node<'a, '_>) -> Language<'a> {
    let one = |node| (text(node, "id"), (at(node), text(node, "value")));
    Language {
        at: at(node),
        name: node.attribute(("http://www.w3.org/XML/1998/namespace", "lang")).unwrap_or_default(),
        texts: children(Some(node), "Text").map(one).collect(),
    }
}
