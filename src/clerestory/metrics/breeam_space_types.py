"""Space types of BREEAM Hea 01, and the daylight illuminance that each requires.

Reference: BRE Global, BREEAM UK New Construction 2018 (SD5078), Hea 01, table 5.3.
"""

from typing import NamedTuple

from clerestory.checks import one_of


class IlluminanceLimits(NamedTuple):
    """What a number of credits requires of the spaces of a type.

    Mean illuminance and lowest illuminance [lux], each for `hours` a year, in spaces
    that have `share_of_area` of the floor area; 0 lux if there is no limit.
    """

    credits: int
    share_of_area: float
    mean_lux: float
    worst_lux: float
    hours: float


class SpaceType(NamedTuple):
    """Type of building and its limits, those for the most credits first.

    `program` is the name of the type in programs of honeybee, after "BREEAM::".
    """

    building: str
    program: str
    limits: tuple[IlluminanceLimits, ...]


_TWO_CREDITS = IlluminanceLimits(2, 0.8, 300.0, 90.0, 2000.0)
_ONE_CREDIT = _TWO_CREDITS._replace(credits=1)
_HEALTHCARE = (_TWO_CREDITS._replace(hours=2650.0), _ONE_CREDIT)
_DWELLING = (IlluminanceLimits(2, 1.0, 100.0, 30.0, 3450.0),)
_SHARED = IlluminanceLimits(2, 0.8, 200.0, 60.0, 2650.0)
_SALES = IlluminanceLimits(1, 0.35, 200.0, 200.0, 2650.0)
_CELLS = IlluminanceLimits(2, 0.8, 100.0, 0.0, 3150.0)
_DETENTION = (IlluminanceLimits(2, 0.8, 300.0, 210.0, 2650.0),)

_EDUCATION, _HEALTH = "Education buildings", "Healthcare buildings"
_RESIDENTIAL, _RETAIL = "Multi-residential buildings", "Retail buildings"
_PRISON = "Prison buildings"

OFFICE = "office"

SPACE_TYPES = {
    OFFICE: SpaceType(
        "Office buildings", "Office_buildings::Occupied_spaces", (_TWO_CREDITS,)
    ),
    "school": SpaceType(_EDUCATION, "Education_buildings::Preschools", (_TWO_CREDITS,)),
    "higher education": SpaceType(
        _EDUCATION,
        "Education_buildings::Higher_education",
        (_TWO_CREDITS, _ONE_CREDIT._replace(share_of_area=0.6)),
    ),
    "creche": SpaceType(
        "Crèche buildings", "Creche_buildings::Occupied_spaces", (_TWO_CREDITS,)
    ),
    "healthcare staff and public": SpaceType(
        _HEALTH, "Healthcare_buildings::Staff_and_public_areas", _HEALTHCARE
    ),
    "healthcare patients": SpaceType(
        _HEALTH,
        "Healthcare_buildings::Patients_areas_and_consulting_rooms",
        _HEALTHCARE,
    ),
    "residential kitchen": SpaceType(
        _RESIDENTIAL, "Multi_residential_buildings::Kitchen", _DWELLING
    ),
    "residential living": SpaceType(
        _RESIDENTIAL,
        "Multi_residential_buildings::Living_rooms_dining_rooms_studies",
        _DWELLING,
    ),
    "residential communal": SpaceType(
        _RESIDENTIAL,
        "Multi_residential_buildings::Non_residential_or_communal_spaces",
        (_SHARED,),
    ),
    "retail sales": SpaceType(_RETAIL, "Retail_buildings::Sales_areas", (_SALES,)),
    "retail other": SpaceType(
        _RETAIL,
        "Retail_buildings::Other_occupied_areas",
        (_SHARED._replace(credits=1),),
    ),
    "prison cell": SpaceType(
        _PRISON, "Prison_buildings::Cells_and_custody_cells", (_CELLS,)
    ),
    "prison association": SpaceType(
        _PRISON, "Prison_buildings::Internal_association_or_atrium", _DETENTION
    ),
    "prison patients": SpaceType(
        _PRISON, "Prison_buildings::Patient_care_spaces", _DETENTION
    ),
    "prison teaching": SpaceType(
        _PRISON,
        "Prison_buildings::Teaching_lecture_and_seminar_spaces",
        (_TWO_CREDITS,),
    ),
    "other": SpaceType(
        "Other buildings", "Other_buildings::Occupied_spaces", (_ONE_CREDIT,)
    ),
}

_PREFIX = "BREEAM::"


def space_type(name: str) -> SpaceType:
    """Return the space type of a name.

    >>> space_type("residential kitchen").limits[0].hours
    3450.0
    """
    one_of(name, "space type of BREEAM", choices=list(SPACE_TYPES))
    return SPACE_TYPES[name]


def space_type_of_program(program: str) -> SpaceType:
    """Return the space type of a program of honeybee; offices if it is another one.

    >>> space_type_of_program("BREEAM::Retail_buildings::Sales_areas").building
    'Retail buildings'
    >>> space_type_of_program("Plenum").building
    'Office buildings'
    """
    plain = program.replace("è", "e")
    for known in SPACE_TYPES.values():
        if plain == _PREFIX + known.program:
            return known
    return SPACE_TYPES[OFFICE]


def program_of(known: SpaceType) -> str:
    """Return the name of the program of honeybee of a space type."""
    return _PREFIX + known.program
