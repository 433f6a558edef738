"""German translations of the interface: English text to German text."""
GERMAN = {
    # Panels, menus, operators.
    "Plausible": "Plausible",
    "Plausible BRDF": "Plausible BRDF",
    "Lobe": "Keule",
    "Color": "Farbe",
    "Sampling": "Abtastung",
    "Energy": "Energie",
    "Albedo Tables": "Albedo-Tabellen",
    "Presets": "Vorlagen",
    "Metals": "Metalle",
    "Plastics": "Kunststoffe",
    "Ceramics": "Keramik",
    "Paints": "Lacke und Farben",
    "Fabrics": "Stoffe",
    "Retroreflectors": "Rückstrahler",
    "Add Plausible Node": "Plausible-Node hinzufügen",
    "Apply Preset": "Vorlage anwenden",
    "Bake LUTs": "Tabellen backen",
    "Bake Weights": "Gewichte backen",
    "Baked for Their Values": "Für ihre Werte gebacken",
    "Cancel": "Abbrechen",
    "Clear": "Leeren",
    "Compare": "Vergleichen",
    "Convert": "Umwandeln",
    "Convert to": "Umwandeln in",
    "Exponent ↔ Roughness": "Exponent ↔ Rauheit",
    "Furnace Test": "Ofentest",
    "Get Blender": "Blender herunterladen",
    "Native Approximation": "Native Näherung",
    "New Plausible Material": "Neues Plausible-Material",
    "Renew Node": "Node erneuern",
    "Render on CPU": "Auf der CPU rendern",
    "Render the Model": "Das Modell rendern",
    "Render with Cycles": "Mit Cycles rendern",
    "Set Metal": "Metall wählen",
    "Switch on OSL": "OSL einschalten",
    "Update Materials": "Materialien aktualisieren",
    "Upgrade Materials": "Materialien hochstufen",
    "Use Shipped Tables": "Mitgelieferte Tabellen verwenden",
    # Parameters.
    "Blend": "Mischung",
    "C_xy 1": "C_xy 1",
    "C_xy 2": "C_xy 2",
    "C_xy 3": "C_xy 3",
    "C_z 1": "C_z 1",
    "C_z 2": "C_z 2",
    "C_z 3": "C_z 3",
    "Conductor": "Leiter",
    "Constant": "Konstant",
    "Controlled": "Kontrolliert",
    "Correlation τ": "Korrelation τ",
    "Diffuse Color": "Diffuse Farbe",
    "Edge Color": "Randfarbe",
    "Exponent": "Exponent",
    "Exponent 1": "Exponent 1",
    "Exponent 2": "Exponent 2",
    "Exponent 3": "Exponent 3",
    "Exponent U": "Exponent U",
    "Exponent V": "Exponent V",
    "Extinction k": "Extinktion k",
    "Fresnel": "Fresnel",
    "Grazing Exponent": "Exponent, streifend",
    "Height σ₀": "Höhe σ₀",
    "Image": "Bild",
    "Light Spread": "Lichtstreuung",
    "Normal": "Normale",
    "Normalized": "Normiert",
    "Pumps": "Aufpumpen",
    "Radius": "Radius",
    "Radius U": "Radius U",
    "Radius V": "Radius V",
    "Refractive Index n": "Brechungsindex n",
    "Renormalize": "Neu normieren",
    "Retro Exponent": "Retro-Exponent",
    "Retro Grazing Exponent": "Retro-Exponent, streifend",
    "Retro Radius U": "Retro-Radius U",
    "Retro Radius V": "Retro-Radius V",
    "Retroreflection": "Rückstrahlung",
    "Rotation": "Drehung",
    "Roughness": "Rauheit",
    "Samples per Hit": "Samples je Treffer",
    "Scattering": "Streuung",
    "Schlick": "Schlick",
    "Second Exponent": "Zweiter Exponent",
    "Second Radius": "Zweiter Radius",
    "Slope": "Neigung",
    "Slope U": "Neigung U",
    "Slope V": "Neigung V",
    "Slope m": "Neigung m",
    "Smoothness s": "Glätte s",
    "Specular Color": "Glanzfarbe",
    "Tangent": "Tangente",
    "Use Roughness": "Rauheit verwenden",
    "Vary with Angle": "Mit dem Winkel ändern",
    "Wavelength": "Wellenlänge",
    "Weight 1": "Gewicht 1",
    "Weight 2": "Gewicht 2",
    "Weight 3": "Gewicht 3",
    # Sentences.
    "Albedo by the angle of the view": "Albedo nach dem Blickwinkel",
    "Albedo by the angle of the view, gray before pumping": "Albedo nach dem Blickwinkel, grau vor dem Aufpumpen",
    "Baked: up to 80° lobes are within {lobe} %, their light within {albedo} %":
        "Gebacken: bis 80° stimmen Keulen auf {lobe} %, ihr Licht auf {albedo} %",
    "Baked over ranges of {names}: up to 80° lobes are within {lobe} %, their light within {albedo} %":
        "Über Bereiche gebacken von {names}: bis 80° stimmen Keulen auf {lobe} %, ihr Licht auf {albedo} %",
    "Baking the weights for these values": "Gewichte für diese Werte werden gebacken",
    "Baking the weights over ranges": "Gewichte werden über Bereiche gebacken",
    "Blender {version} is too old: this needs 4.2 or later": "Blender {version} ist zu alt: nötig ist 4.2 oder neuer",
    "Cycles renders the native approximation in place of the model":
        "Cycles rendert die native Näherung anstelle des Modells",
    "Cycles renders the native approximation in place of the model. Its lobe differs by {lobe:.2g} %, its albedo by "
    "{albedo:.2g} %":
        "Cycles rendert die native Näherung anstelle des Modells. Ihre Keule weicht um {lobe:.2g} % ab, ihre Albedo um "
        "{albedo:.2g} %",
    "Exponent {exponent:.6g} is beyond the material's tables, which are for {low:g} to {high:g}: it renders striped":
        "Der Exponent {exponent:.6g} liegt außerhalb der Tabellen des Materials, die für {low:g} bis {high:g} "
        "gelten: es "
        "rendert gestreift",
    "Furnace test, render {done} of {total}": "Ofentest, Bild {done} von {total}",
    "Furnace test, starting": "Ofentest beginnt",
    "Gives more light than it gets: {times:.3g} times at {view:.3g}°":
        "Gibt mehr Licht, als es bekommt: das {times:.3g}-fache bei {view:.3g}°",
    "Lobes f N·L, with their peaks in 1/sr": "Keulen f N·L, mit ihren Spitzen in 1/sr",
    "Lobes f N·L by their cube root, with their peaks in 1/sr":
        "Keulen f N·L als Kubikwurzel, mit ihren Spitzen in 1/sr",
    "Lobes f N·L by their square root, with their peaks in 1/sr":
        "Keulen f N·L als Quadratwurzel, mit ihren Spitzen in 1/sr",
    "Made by an earlier version of the extension": "Von einer früheren Version der Erweiterung gemacht",
    "Made by version {version} of the extension: this one is older and may not know all of it":
        "Von Version {version} der Erweiterung gemacht: diese hier ist älter und kennt vielleicht nicht alles davon",
    "Materials keep the tables compiled into them until they are updated":
        "Materialien behalten ihre eingebauten Tabellen, bis sie aktualisiert werden",
    "Measured for other values than now": "Für andere Werte gemessen als jetzt",
    "Measured; there is no formula for a material with something plugged in or mixed":
        "Gemessen; für ein Material, in das etwas eingesteckt oder gemischt ist, gibt es keine Formel",
    "Not upgraded: {names}": "Nicht hochgestuft: {names}",
    "OSL on GPU needs OptiX, and these materials more room than Cycles has there: render on the CPU, or what Cycles "
    "ships in place of the model":
        "OSL auf der GPU braucht OptiX, und diese Materialien mehr Platz, als Cycles dort hat: auf der CPU rendern, "
        "oder was Cycles anstelle des Modells mitbringt",
    "On the GPU these materials ask for more room than Cycles has: render on the CPU, or what Cycles ships in place of "
    "the model":
        "Auf der GPU brauchen diese Materialien mehr Platz, als Cycles hat: auf der CPU rendern, oder was Cycles "
        "anstelle des Modells mitbringt",
    "Only Cycles renders the model; other engines show a stand-in":
        "Nur Cycles rendert das Modell; andere Engines zeigen einen Ersatz",
    "Open Shading Language is off in this scene: Plausible materials render black":
        "Open Shading Language ist in dieser Szene aus: Plausible-Materialien rendern schwarz",
    "Open Shading Language is on for this scene": "Open Shading Language ist für diese Szene an",
    "Seen along the tangent": "Entlang der Tangente gesehen",
    "Seen at a slant the lump is shrunk to a radius of 1 - sin θ, its shape kept, so that it stays on the disk and no "
    "light is lost":
        "Schräg gesehen schrumpft der Buckel auf einen Radius von 1 - sin θ, in gleicher Form, damit er auf der "
        "Scheibe bleibt und kein Licht verloren geht",
    "The furnace agrees with the formula: at most {most:.4f} off, at {view:g}°":
        "Der Ofen stimmt mit der Formel überein: höchstens {most:.4f} daneben, bei {view:g}°",
    "The furnace differs from the formula: at most {most:.4f} off, at {view:g}°":
        "Der Ofen weicht von der Formel ab: höchstens {most:.4f} daneben, bei {view:g}°",
    "The node is rendered by a backend that this version of the extension does not know: {name}":
        "Den Node rendert ein Backend, das diese Version der Erweiterung nicht kennt: {name}",
    "The node is of a model that this version of the extension does not know: {name}":
        "Der Node ist von einem Modell, das diese Version der Erweiterung nicht kennt: {name}",
    "The node was edited and its shader is gone or damaged":
        "Der Node wurde bearbeitet, und sein Shader fehlt oder ist beschädigt",
    "The node was edited and lacks {names}": "Der Node wurde bearbeitet, und ihm fehlt {names}",
    "The weights are for other values": "Die Gewichte gelten für andere Werte",
    "Too noisy to tell: at most {most:.4f} off, at {view:g}°":
        "Zu verrauscht für ein Urteil: höchstens {most:.4f} daneben, bei {view:g}°",
    "Upgraded to {version}: {names}. The file on disk is as it was until you save":
        "Auf {version} hochgestuft: {names}. Die Datei auf der Platte ist, wie sie war, bis Sie speichern",
    "{node} was edited and lacks {names}: Renew Node in the panel makes it whole":
        "{node} wurde bearbeitet, und ihm fehlt {names}: Node erneuern im Panel macht ihn wieder ganz",
    "{parameter} is driven by {node}: plotted for the value of its socket":
        "{parameter} wird von {node} bestimmt: gezeichnet für den Wert des Sockels",
}
